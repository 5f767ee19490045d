"""Refinement: what it keeps through a QR, what it gains, and that it gives back the better one."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="refining needs the extra gemheads[train]")

from gemheads.models.captures.reader import Capture, open_capture  # noqa: E402
from gemheads.models.gem import MODALITIES, Gem  # noqa: E402
from gemheads.models.importers.adopt import adopt  # noqa: E402
from gemheads.models.importers.baremesh import capture_source  # noqa: E402
from gemheads.models.posing import pose_head  # noqa: E402
from gemheads.models.train.perceptual import TINY, Perceptual  # noqa: E402
from gemheads.models.train.synthesis.fit import HeadPose, Start  # noqa: E402
from gemheads.models.train.synthesis.freegem import FreeGem  # noqa: E402
from gemheads.models.train.synthesis.refine import ASIDE, OWN, RefineEffort, refine  # noqa: E402
from gemheads.models.train.synthesis.unfinished import Unfinished  # noqa: E402
from gemheads.render.software import SoftwareEngine  # noqa: E402

Toy = tuple[Capture, Gem, dict[int, Start]]


@pytest.fixture(scope="module")
def toy(toy_capture: Path) -> Toy:
    """The capture, the avatar of its bare mesh, and its moments."""
    capture = open_capture(toy_capture)
    source = capture_source(capture, 24)
    gem, _ = adopt(source, "Toy", 4)
    moments = {}
    for timestep, frame in zip(source.moments, source.frames(), strict=True):
        tracked = capture.tracked(timestep)
        moments[timestep] = Start(gem.project(frame), HeadPose(tracked.rotation, tracked.translation))
    return capture, gem, moments


def stacked(moments: dict[int, Start]) -> np.ndarray:
    return np.stack([moment.coefficients for moment in moments.values()])


def drawn(gem: Gem, coefficients: np.ndarray, capture: Capture, index: int) -> np.ndarray:
    shot = capture.val[index]
    tracked = capture.tracked(shot.timestep)
    raw = pose_head(gem.compose(coefficients), gem.neck_weights, gem.neck_pivot, tracked.rotation, tracked.translation)
    return SoftwareEngine().draw(raw, shot.camera).copy()


def test_orthonormal_bases_and_the_same_picture(toy: Toy) -> None:
    capture, gem, moments = toy
    free = FreeGem(gem, stacked(moments))
    generator = torch.Generator().manual_seed(0)
    with torch.no_grad():
        for name in MODALITIES:
            one = free.components[name]
            one += 0.3 * one.abs().mean() * torch.randn(one.shape, generator=generator)
    before = [free.compose(index) for index in range(len(moments))]
    gram = free.components["position"] @ free.components["position"].T
    assert (gram - torch.eye(len(gram))).abs().max() > 1e-3
    free.orthonormalise()
    for name in MODALITIES:
        basis = free.components[name]
        assert not len(basis) or (basis @ basis.T - torch.eye(len(basis))).abs().max() < 1e-5
    finished, found = free.finished()
    for index, raw in enumerate(before):
        again = free.compose(index)
        for one, two in zip(raw, again, strict=True):
            assert (one - two).abs().max() < 1e-5
        shot = capture.val[index]
        fields = (values.detach().numpy() for values in raw)
        wanted = SoftwareEngine().draw(type(gem.compose(gem.rest_coefficients))(*fields), shot.camera).copy()
        got = SoftwareEngine().draw(finished.compose(found[index]), shot.camera)
        assert np.abs(wanted - got).max() < 1e-4


def test_what_is_finished_is_like_what_is_distilled(toy: Toy) -> None:
    _, gem, moments = toy
    begin = stacked(moments)
    free = FreeGem(gem, begin)
    with torch.no_grad():
        free.whitened += 0.5  # a mean that is not 0
        free.components["position"].mul_(1.5)
    composed = [free.compose(index).positions.detach().numpy() for index in range(len(begin))]
    finished, found = free.finished()
    for name in MODALITIES:
        here = finished.slices[name]
        if here.stop > here.start:
            np.testing.assert_allclose(found[:, here].mean(0), 0, atol=1e-5)
            np.testing.assert_allclose(found[:, here].std(0, ddof=1), finished.sigma[here], rtol=1e-3, atol=1e-5)
            assert (np.diff(finished.sigma[here]) <= 1e-7).all()
    for index, positions in enumerate(composed):
        np.testing.assert_allclose(finished.compose(found[index]).positions, positions, atol=1e-5)


def test_an_avatar_of_a_single_moment_is_refined_without_a_warning(toy: Toy) -> None:
    capture, gem, moments = toy
    still = gem.truncated(0)
    answer = refine(still, capture, {2: replace(moments[2], coefficients=still.rest_coefficients)}, RefineEffort(20))
    assert answer.after > answer.before
    assert answer.gem.coefficient_count == 0
    assert np.isfinite(answer.gem.bases["position"].mean).all()


def test_rest_and_arkit_map_go_along(toy: Toy) -> None:
    _, gem, moments = toy
    assert gem.arkit_weights is not None
    free = FreeGem(gem, stacked(moments))
    with torch.no_grad():
        for one in free.components.values():
            one.copy_(one.flip(0) * 1.1)  # another basis of the same space
    finished, _ = free.finished()
    weights = np.zeros(52, np.float32)
    weights[17] = 0.7
    old, new = gem.arkit_coefficients(weights), finished.arkit_coefficients(weights)
    reversed_bases = {
        name: replace(basis, rows=np.ascontiguousarray(np.concatenate([basis.rows[:1], 1.1 * basis.rows[:0:-1]])))
        for name, basis in gem.bases.items()
    }
    wanted = replace(gem, bases=reversed_bases).compose(old)
    np.testing.assert_allclose(finished.compose(new).positions, wanted.positions, atol=1e-5)


def test_held_out_views_improve_and_everything_is_kept_consistent(toy: Toy) -> None:
    capture, gem, moments = toy
    result = refine(gem, capture, moments, RefineEffort(iterations=120))
    assert result.improved
    assert result.after > result.before + 1
    assert len(result.losses) == result.iterations == 120
    assert np.mean(result.losses[-20:]) < 0.8 * np.mean(result.losses[:20])
    for basis in result.gem.bases.values():
        assert np.abs(basis.components @ basis.components.T - np.eye(len(basis))).max(initial=0) < 1e-5
    qualities = []
    for index, shot in enumerate(capture.val):
        rgba = capture.read(shot) / 255.0
        image = drawn(result.gem, result.moments[shot.timestep].coefficients, capture, index)
        truth = rgba[..., :3] * rgba[..., 3:] + 1 - rgba[..., 3:]
        qualities.append(-10 * np.log10(np.mean((image[..., :3] + 1 - image[..., 3:] - truth) ** 2)))
    assert np.mean(qualities) == pytest.approx(result.after, abs=0.05)


def test_the_same_seed_gives_the_same_avatar(toy: Toy) -> None:
    capture, gem, moments = toy
    one, two = (refine(gem, capture, moments, RefineEffort(iterations=12)) for _ in range(2))
    assert one.losses == two.losses
    np.testing.assert_array_equal(one.gem.bases["position"].rows, two.gem.bases["position"].rows)


def test_what_is_fixed_stays(toy: Toy) -> None:
    capture, gem, moments = toy
    effort = RefineEffort(iterations=20, coefficients=False, colors=False)
    result = refine(gem, capture, moments, effort, Perceptual(TINY))
    assert result.improved
    np.testing.assert_array_equal(result.gem.colors, gem.colors)


def test_the_better_one_is_kept(toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    capture, gem, moments = toy
    monkeypatch.setattr("gemheads.models.train.synthesis.refine.RATES", dict.fromkeys(MODALITIES, 5.0))
    monkeypatch.setattr("gemheads.models.train.synthesis.refine.SLOWER", 1.0)
    result = refine(gem, capture, moments, RefineEffort(iterations=10))
    assert not result.improved
    assert result.gem is gem
    assert result.after == result.before
    assert min(quality for _, quality in result.curve) < result.before
    np.testing.assert_allclose(stacked(dict(result.moments)), stacked(moments), rtol=1e-6)


def test_steps_that_made_it_worse_become_smaller(toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    capture, gem, moments = toy
    monkeypatch.setattr("gemheads.models.train.synthesis.refine.RATES", dict.fromkeys(MODALITIES, 5.0))
    result = refine(gem, capture, moments, RefineEffort(iterations=30))
    assert result.curve[1][1] < result.before
    assert result.improved


def test_stopped_it_gives_what_it_has(toy: Toy) -> None:
    capture, gem, moments = toy

    def stop(stage: str, done: int, total: int) -> None:
        if done == 60:
            raise KeyboardInterrupt

    result = refine(gem, capture, moments, RefineEffort(iterations=1000), progress=stop)
    assert (result.stopped, result.iterations) == (True, 60)
    assert result.improved


def test_without_a_held_out_camera_pictures_are_set_aside(toy: Toy) -> None:
    capture, gem, moments = toy
    result = refine(gem, replace(capture, val=()), moments, RefineEffort(iterations=40))
    assert result.improved
    assert result.judged_by == ASIDE
    assert len(result.judges) == len(capture.train) // 10
    assert result.moments.keys() == moments.keys()


def test_where_nothing_can_be_set_aside_that_is_said(toy: Toy) -> None:
    capture, gem, moments = toy
    alone = replace(capture, val=(), train=tuple(shot for shot in capture.train if shot.camera_index == 0))
    result = refine(gem, alone, moments, RefineEffort(iterations=10))
    assert result.judged_by == OWN
    assert result.judges == alone.train
    assert result.moments.keys() == moments.keys()


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda k: {}, "no training picture"),
        (lambda k: {99: next(iter(k.values()))}, "no training picture"),
        (lambda k: {t: Start(v.coefficients[:3], v.pose) for t, v in k.items()}, r"coefficients, moment 0 \(3,\)"),
    ],
)
def test_moments_that_do_not_fit_are_refused(toy: Toy, spoil: Callable[[dict], dict], said: str) -> None:
    capture, gem, moments = toy
    with pytest.raises(ValueError, match=said):
        refine(gem, capture, spoil(moments), RefineEffort(iterations=1))


@pytest.mark.parametrize("last", [0, 4, 15, 30])
def test_killed_it_goes_on_to_the_same(toy: Toy, tmp_path: Path, last: int) -> None:
    """After this many steps; judged, and kept, after every third."""
    capture, gem, moments = toy
    effort, steps = RefineEffort(iterations=30, interval=3), []
    unfinished = Unfinished(tmp_path / "unfinished", "this")

    class Killed(BaseException):
        """As little is done after it as after a kill."""

    def kill(stage: str, done: int, total: int) -> None:
        if done > last:
            raise Killed

    def count(stage: str, done: int, total: int) -> None:
        steps.append(done)

    with suppress(Killed):
        refine(gem, capture, moments, effort, progress=kill, unfinished=unfinished)
    went_on = refine(gem, capture, moments, effort, progress=count, unfinished=unfinished)
    whole = refine(gem, capture, moments, effort)
    assert steps == list(range(last // 3 * 3 + 1, 31))
    assert (went_on.losses, went_on.curve, went_on.after) == (whole.losses, whole.curve, whole.after)
    for name in MODALITIES:
        np.testing.assert_array_equal(went_on.gem.bases[name].rows, whole.gem.bases[name].rows)
    np.testing.assert_array_equal(stacked(dict(went_on.moments)), stacked(dict(whole.moments)))


def test_what_is_kept_of_another_one_or_broken_is_not_gone_on_with(toy: Toy, tmp_path: Path) -> None:
    capture, gem, moments = toy
    path = tmp_path / "unfinished"
    refine(gem, capture, moments, RefineEffort(iterations=2), unfinished=Unfinished(path, "this"))
    assert Unfinished(path, "this").read() is not None
    assert Unfinished(path, "that").read() is None
    path.write_bytes(path.read_bytes()[:-100])
    assert Unfinished(path, "this").read() is None
    Unfinished(path, "this").remove()
    assert not path.exists()
