"""The bench of ablations, small: its models are what they are called, and the product's own is among them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch", reason="ablations need the extra gemheads[train]")

import toycapture
from gemheads.models.captures.reader import Capture, open_capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.metrics.pixels import psnr
from gemheads.models.train.avatars.plan import Plan
from gemheads.models.train.avatars.run_source import run_source
from gemheads.models.train.avatars.runs import Run, open_run
from gemheads.models.train.avatars.train_avatar import train_avatar
from gemheads.render.gaussians import RawGaussians
from gemheads.render.rotations import sign_aligned

from .bases import Linear, joint, led_by_positions, off_orthonormal, one_each
from .fitting import Searched, fitted
from .lines import AS_IT_IS, Ablation, Effort
from .spaces import Space

SMALL = Effort(components=2, shots=2, iterations=4, evaluations=6)


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Capture:
    return open_capture(toycapture.write_capture(tmp_path_factory.mktemp("toy") / "capture"))


@pytest.fixture(scope="module")
def run(capture: Capture, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("run")
    train_avatar(capture, folder, Plan(32, 4, 2, steps=20, colors_first=4, preview_every=100))
    return open_run(folder)


@pytest.fixture(scope="module")
def frames(run: Run) -> list[RawGaussians]:
    return list(run_source(run).frames())


@pytest.mark.parametrize(("activated", "tangent"), [(False, False), (True, False), (False, True)])
def test_a_layout_loses_nothing(frames: list[RawGaussians], activated: bool, tangent: bool) -> None:
    space = Space(frames[0], activated, tangent)
    row = space.row(frames[3])
    assert [len(part) for part in row] == [len(frames[0]) * width for width in (3, 3 if tangent else 4, 3, 1)]
    back = space.splats(row)
    for name in ("positions", "log_scales", "opacity_logits"):
        np.testing.assert_allclose(getattr(back, name), getattr(frames[3], name), atol=2e-4, err_msg=name)
    np.testing.assert_allclose(sign_aligned(back.wxyz, frames[3].wxyz), frames[3].wxyz, atol=1e-5)


def test_what_is_linear_may_leave_what_is_possible(frames: list[RawGaussians]) -> None:
    space = Space(frames[0], activated=True)
    positions, rotation, scales, opacities = space.row(frames[0])
    cut = space.splats((positions, rotation, scales - 1, opacities + 2))
    assert space.impossible((positions, rotation, scales - 1, opacities)) == 1
    assert space.impossible(space.row(frames[0])) == 0
    assert np.isfinite(cut.log_scales).all()
    assert np.isfinite(cut.opacity_logits).all()


def test_as_it_is_is_the_product(capture: Capture, run: Run, frames: list[RawGaussians]) -> None:
    ablation = Ablation(capture, run, SMALL)
    space = Space(frames[0])
    model = one_each([space.row(frame) for frame in frames], SMALL.components)
    for raw in ablation.held_out:
        wanted = ablation.gem.compose(ablation.gem.project(raw))
        found = space.splats(model.answer(space.row(raw)))
        np.testing.assert_allclose(found.positions, wanted.positions, atol=1e-6)
        np.testing.assert_allclose(found.log_scales, wanted.log_scales, atol=1e-4)
    assert off_orthonormal(model.components) < 1e-9
    assert off_orthonormal([2 * model.components[0]]) == pytest.approx(3)


def test_shared_coefficients_are_fewer_at_the_same_size(frames: list[RawGaussians]) -> None:
    space = Space(frames[0])
    rows = [space.row(frame) for frame in frames]
    own, one, led = (make(rows, 2) for make in (one_each, joint, led_by_positions))
    assert own.numbers == one.numbers == led.numbers
    assert (own.count, one.count, led.count) == (8, 2, 2)
    errors = [
        sum(float(((a - b) ** 2).sum()) for a, b in zip(m.answer(rows[0])[1:], rows[0][1:], strict=True))
        for m in (own, led)
    ]
    assert errors[0] < errors[1]
    all_of_it = joint(rows, 5)
    for found, wanted in zip(all_of_it.answer(rows[2]), rows[2], strict=True):
        np.testing.assert_allclose(found, wanted, atol=1e-6)


@pytest.mark.parametrize("make", [one_each, joint, led_by_positions])
def test_a_fit_comes_nearer(
    capture: Capture, run: Run, frames: list[RawGaussians], make: Callable[..., Linear]
) -> None:
    ablation = Ablation(capture, run, SMALL)
    space = Space(frames[0])
    model = Searched.of(make([space.row(frame) for frame in frames], 2), ablation.gem)
    shot = ablation.shots[0]
    standin, truth = StandIn(capture), ablation.taken[0]
    others = [other for other in capture.test if other.timestep == shot.timestep][:2]
    before, after = (fitted(model, capture, others, evaluations) for evaluations in (1, 8))
    drawn = [standin.draw(raw, ablation.gem.neck_weights, ablation.gem.neck_pivot, shot) for raw in (before, after)]
    assert psnr(drawn[1], truth) > psnr(drawn[0], truth)


def test_every_line_is_measured(capture: Capture, run: Run, tmp_path: Path) -> None:
    lines = {line.name: line for line in Ablation(capture, run, SMALL).lines(tmp_path)}
    assert len(lines) == 10
    assert [line.to_run is None for line in lines.values()] == [True] + 9 * [False]
    assert all(np.isfinite([line.to_taken.moving, line.to_taken.everywhere]).all() for line in lines.values())
    assert lines[AS_IT_IS].impossible == 0
    assert lines["fp32 basis"].to_taken.moving == pytest.approx(lines[AS_IT_IS].to_taken.moving, abs=0.01)
    sizes = [lines[f"{kind} basis"].megabytes or 0 for kind in ("int8", "fp16", "fp32")]
    assert 0 < sizes[0] < sizes[1] < sizes[2]
    assert (lines["fp32 basis"].off_orthonormal or 1) < 1e-5 < (lines["int8 basis"].off_orthonormal or 0)
    assert sum(line.fitted is not None for line in lines.values()) == 4
