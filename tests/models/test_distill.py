"""Distillation against the plain SVD, and what an ensemble can do wrong."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models import distill as distilling
from gemheads.models.distill import distill
from gemheads.models.gem import CHANNELS, MODALITIES
from gemheads.render.gaussians import RawGaussians

SPLATS, FRAMES, RANK = 50, 30, 8
MAPPED = Path("/proc/self/maps")
VALUES = {"position": "positions", "rotation": "wxyz", "scale": "log_scales", "opacity": "opacity_logits"}


def ensemble(frames: int = FRAMES, rank: int = RANK, seed: int = 0) -> list[RawGaussians]:
    """Frames that ``rank`` hidden controls move, each modality in its own way."""
    rng = np.random.default_rng(seed)
    controls = rng.normal(size=(frames, rank)) * np.geomspace(1, 0.01, rank)
    made = {}
    for name, attribute in VALUES.items():
        channels = CHANNELS[name]
        mean = rng.normal(size=(SPLATS, channels))
        if name == "rotation":
            mean = mean / np.linalg.norm(mean, axis=1, keepdims=True)
        moves = 0.05 * rng.normal(size=(rank, SPLATS, channels))
        values = (mean + np.tensordot(controls, moves, 1)).astype(np.float32)
        made[attribute] = values[..., 0] if name == "opacity" else values
    colors = rng.random((SPLATS, 3), np.float32)
    return [RawGaussians(*(made[a][f] for a in VALUES.values()), colors) for f in range(frames)]


def matrix(frames: list[RawGaussians], name: str) -> np.ndarray:
    return np.stack([getattr(frame, VALUES[name]).reshape(-1) for frame in frames]).astype(np.float64)


@pytest.mark.parametrize("name", MODALITIES)
def test_it_is_the_plain_svd(name: str) -> None:
    frames = ensemble()
    answer = distill(frames, 5)
    data = matrix(frames, name)
    _, singular, directions = np.linalg.svd(data - data.mean(0), full_matrices=False)
    basis = answer.bases[name]
    np.testing.assert_allclose(basis.mean, data.mean(0), atol=1e-6)
    np.testing.assert_allclose(basis.sigma, singular[:5] / np.sqrt(FRAMES - 1), rtol=1e-4)
    cosines = np.abs((basis.components * directions[:5]).sum(1))
    np.testing.assert_allclose(cosines, 1, atol=1e-5)
    np.testing.assert_allclose(basis.components @ basis.components.T, np.eye(5), atol=1e-5)
    shares = np.cumsum(singular**2)[:5] / (singular**2).sum()
    np.testing.assert_allclose(answer.variance_kept[name], shares, rtol=1e-4)


def test_rank_components_give_every_frame_back() -> None:
    frames = ensemble()
    answer = distill(frames, 50)
    for name in MODALITIES:
        basis, data = answer.bases[name], matrix(frames, name)
        assert len(basis) == RANK, name
        again = basis.mean + (data - basis.mean) @ basis.components.T @ basis.components
        np.testing.assert_allclose(again, data, atol=1e-5)
        np.testing.assert_allclose(answer.variance_kept[name][-1], 1, atol=1e-6)


def test_blocks_are_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = distill(ensemble(), 5)
    monkeypatch.setattr(distilling, "BLOCK_BYTES", 4 * FRAMES * 7)  # seven columns at a time
    blocks = distill(ensemble(), 5)
    for name in MODALITIES:
        np.testing.assert_allclose(blocks.bases[name].rows, whole.bases[name].rows, atol=1e-5)
        np.testing.assert_allclose(blocks.bases[name].sigma, whole.bases[name].sigma, rtol=1e-5)


def test_the_same_frames_give_the_same_basis() -> None:
    first, second = distill(iter(ensemble())), distill(ensemble())
    for name in MODALITIES:
        np.testing.assert_array_equal(first.bases[name].rows, second.bases[name].rows)
        largest = np.abs(first.bases[name].components).argmax(1)
        assert (first.bases[name].components[np.arange(len(largest)), largest] > 0).all()


def test_a_modality_may_have_its_own_count() -> None:
    counts = {"position": 6, "rotation": 3, "scale": 1, "opacity": 0}
    assert {name: len(basis) for name, basis in distill(ensemble(), counts).bases.items()} == counts


def test_the_sign_of_a_quaternion_does_not_matter() -> None:
    frames = ensemble()
    rng = np.random.default_rng(9)
    flipped = [
        replace(frame, wxyz=frame.wxyz * rng.choice([-1, 1], (SPLATS, 1)).astype(np.float32)) for frame in frames
    ]
    flipped[0] = frames[0]
    np.testing.assert_array_equal(distill(flipped).bases["rotation"].rows, distill(frames).bases["rotation"].rows)


def test_what_does_not_move_has_no_component() -> None:
    frames = ensemble()
    still = [
        replace(frame, log_scales=frames[0].log_scales, opacity_logits=frames[0].opacity_logits) for frame in frames
    ]
    answer = distill(still)
    assert len(answer.bases["scale"]) == len(answer.bases["opacity"]) == 0
    assert len(answer.bases["position"]) == RANK
    np.testing.assert_allclose(answer.bases["scale"].mean, frames[0].log_scales.reshape(-1), rtol=1e-6)


def test_one_frame_is_a_mean() -> None:
    frames = ensemble(frames=1)
    answer = distill(frames)
    assert answer.frames == 1
    for name in MODALITIES:
        assert len(answer.bases[name]) == 0
        np.testing.assert_allclose(answer.bases[name].mean, matrix(frames, name)[0], rtol=1e-6)


def test_few_frames_give_few_components() -> None:
    answer = distill(ensemble(frames=4), 50)
    assert {len(basis) for basis in answer.bases.values()} == {3}


def test_colours_are_averaged() -> None:
    frames = ensemble(frames=2)
    frames[1] = replace(frames[1], colors=np.zeros((SPLATS, 3), np.float32))
    np.testing.assert_allclose(distill(frames).colors, frames[0].colors / 2, rtol=1e-6)


def test_no_frame_is_refused() -> None:
    with pytest.raises(ValueError, match="there is no frame"):
        distill([])


def test_another_number_of_splats_is_refused() -> None:
    frames = ensemble()
    short = RawGaussians(*(getattr(frames[2], name)[:-1] for name in (*VALUES.values(), "colors")))
    with pytest.raises(ValueError, match="frame 2 has 49 splats, the first has 50"):
        distill([*frames[:2], short])


@pytest.mark.parametrize(("name", "attribute"), VALUES.items())
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(name: str, attribute: str, bad: float) -> None:
    frames = ensemble()
    values = getattr(frames[3], attribute).copy()
    values.reshape(-1)[5] = bad
    frames[3] = replace(frames[3], **{attribute: values})
    with pytest.raises(ValueError, match=f"frame 3 has a {name} that is not finite"):
        distill(frames)


@pytest.mark.skipif(not MAPPED.exists(), reason="only Linux tells what is mapped")
def test_no_file_is_mapped_any_more_when_the_folder_is_removed(monkeypatch: pytest.MonkeyPatch) -> None:
    mapped = []

    class Watched(tempfile.TemporaryDirectory[str]):
        def cleanup(self) -> None:
            mapped.append(self.name in MAPPED.read_text())
            super().cleanup()

    monkeypatch.setattr(distilling.tempfile, "TemporaryDirectory", Watched)
    distill(ensemble(), 5)
    assert mapped == [False]
