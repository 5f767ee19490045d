"""PLY sequences: what was exported comes back, with the head held still."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.gem import CHANNELS, Gem
from gemheads.models.importers import adopt as adopting
from gemheads.models.importers.adopt import adopt
from gemheads.models.importers.foreign import ForeignFormatError
from gemheads.models.importers.plysequence import open_sequence, ply_files
from gemheads.models.importers.stillness import held_still, turned
from gemheads.models.ply import save_ply_sequence
from gemheads.models.posing import pose_head
from gemheads.render.gaussians import RawGaussians
from gemheads.render.projection import LOG_SCALE_MIN
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec
from plyfile import PlyData, PlyElement

SPLATS = 300


def head(smile: float = 0.0) -> RawGaussians:
    """A ball of splats; ``smile`` moves a tenth of them."""
    rng = np.random.default_rng(5)
    positions = rng.normal(size=(SPLATS, 3))
    positions *= 0.12 / np.linalg.norm(positions, axis=1, keepdims=True)
    positions[:30, 1] += 0.01 * smile
    wxyz = rng.normal(size=(SPLATS, 4))
    scales, logits = rng.uniform(-6, -4, (SPLATS, 3)), np.full(SPLATS, 2.0)
    parts = (positions, wxyz, scales + 0.05 * smile, logits, rng.uniform(0, 1, (SPLATS, 3)))
    return RawGaussians(*(part.astype(np.float32) for part in parts))


def turning(raw: RawGaussians, rotvec: tuple[float, ...], move: tuple[float, ...]) -> RawGaussians:
    return pose_head(raw, np.ones(len(raw), np.float32), np.zeros(3, np.float32), np.array(rotvec), np.array(move))


def test_head_motion_is_taken_out() -> None:
    moved = turning(head(1.0), (0.2, -0.5, 0.1), (0.05, -0.02, 0.3))
    still = held_still(moved, head())
    np.testing.assert_allclose(still.positions, head(1.0).positions, atol=2e-4)
    np.testing.assert_allclose(matrix_from_wxyz(still.wxyz), matrix_from_wxyz(head().wxyz), atol=5e-3)


def test_turning_before_is_the_product_of_matrices() -> None:
    rotation = matrix_from_wxyz(wxyz_from_rotvec(np.array([0.3, -2.0, 1.0])))
    wxyz = head().wxyz
    np.testing.assert_allclose(matrix_from_wxyz(turned(wxyz, rotation)), rotation @ matrix_from_wxyz(wxyz), atol=1e-5)


def test_a_sequence_becomes_an_avatar(tmp_path: Path) -> None:
    smiles = [0, 0.5, 1, 0.25, 0.75]
    frames = [turning(head(s), (0, 0.1 * i, 0), (0.01 * i, 0, 0)) for i, s in enumerate(smiles)]
    save_ply_sequence(frames, tmp_path / "frames")
    source = open_sequence(tmp_path / "frames")
    gem, distilled = adopt(source, "Ball", 10)
    assert gem.arkit_weights is None
    assert distilled.variance_kept["position"][0] > 0.98, "one smile, and next to no head motion"
    first, smiling = (gem.compose(gem.project(frame)) for frame in list(source.frames())[:3:2])
    np.testing.assert_allclose(gem.compose(gem.rest_coefficients).positions, first.positions, atol=1e-5)
    moved = smiling.positions - first.positions
    np.testing.assert_allclose(moved[:30, 1].mean(), 0.01, atol=3e-4)
    assert np.abs(moved[30:]).max() < 3e-4
    np.testing.assert_allclose(gem.colors, head().colors, atol=1e-5)


def test_centimetres_need_a_scale(tmp_path: Path) -> None:
    large = head()
    large.positions[:] *= 100
    large.log_scales[:] += np.log(np.float32(100))
    save_ply_sequence([large], tmp_path)
    with pytest.raises(ForeignFormatError, match=r"23\.7 m high, no head is; give --scale"):
        open_sequence(tmp_path)
    source = open_sequence(tmp_path, 0.01)
    np.testing.assert_allclose(np.ptp(source.rest.positions, axis=0), np.ptp(head().positions, axis=0), rtol=1e-4)
    np.testing.assert_allclose(source.rest.log_scales, head().log_scales, atol=1e-5)
    assert len(adopt(source, "Still", 5)[0].bases["position"]) == 0


def test_components_that_few_frames_cannot_have_do_not_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_ply_sequence([head(0), head(1), head(2)], tmp_path)
    source = open_sequence(tmp_path)
    bytes_a_row = 4 * sum(CHANNELS.values()) * source.splats
    monkeypatch.setattr(adopting, "MAX_EXPANDED_BYTES", bytes_a_row * (source.count + 1))
    adopt(source, "Still", 50)
    monkeypatch.setattr(adopting, "MAX_EXPANDED_BYTES", bytes_a_row * (source.count - 1))
    with pytest.raises(adopting.TooLargeError, match="components at most"):
        adopt(source, "Still", 50)


def test_flat_splats_in_millimetres_stay_to_be_seen(tmp_path: Path) -> None:
    """Discs, as surfels are, have no thickness; scaled down they would be thinner than any engine draws."""
    discs = head()
    discs.positions[:] *= 1000
    discs.log_scales[:] += np.log(np.float32(1000))
    discs.log_scales[:, 2] = -23
    save_ply_sequence([discs], tmp_path)
    assert open_sequence(tmp_path, 0.001).rest.log_scales.min() >= LOG_SCALE_MIN


def test_a_rest_that_is_rare_is_within_reach(tmp_path: Path) -> None:
    """Coefficients are clamped to 3 sigma: of thirty frames the first alone is at rest."""
    save_ply_sequence([head(), *(head(0.02) for _ in range(29))], tmp_path)
    gem, _ = adopt(open_sequence(tmp_path), "Smiling", 5)
    np.testing.assert_allclose(gem.clamped(gem.rest_coefficients), gem.rest_coefficients)


def test_a_pattern_that_is_none_is_told(tmp_path: Path) -> None:
    with pytest.raises(ForeignFormatError, match="is no pattern"):
        ply_files(tmp_path / "**m.ply")


def test_frames_come_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for name in ("head_10.ply", "head_9.ply", "head_0100.ply", "other.ply", "head_1.png"):
        (tmp_path / name).touch()
    assert [path.name for path in ply_files(tmp_path / "head_*.ply")] == ["head_9.ply", "head_10.ply", "head_0100.ply"]
    assert len(ply_files(tmp_path)) == 4
    assert ply_files(tmp_path / "other.ply") == [tmp_path / "other.ply"]
    with pytest.raises(ForeignFormatError, match="no PLY file; give a folder"):
        ply_files(tmp_path / "nobody_*.ply")


def test_what_macos_puts_beside_a_file_is_no_frame(tmp_path: Path) -> None:
    for name in ("head_1.ply", "._head_1.ply"):
        (tmp_path / name).touch()
    assert ply_files(tmp_path) == [tmp_path / "head_1.ply"]


def test_only_the_constant_part_of_colours_is_taken_and_that_is_said(tmp_path: Path) -> None:
    raw = head()
    names = [f"f_rest_{i}" for i in range(3)] + "x y z opacity f_dc_0 f_dc_1 f_dc_2".split()
    names += [f"scale_{i}" for i in range(3)] + [f"rot_{i}" for i in range(4)]
    table = np.zeros(SPLATS, [(name, "<f4") for name in names])
    for i in range(3):
        table["xyz"[i]], table[f"scale_{i}"] = raw.positions[:, i], raw.log_scales[:, i]
        table[f"f_dc_{i}"] = (raw.colors[:, i] - 0.5) / 0.28209479177387814
    for i in range(4):
        table[f"rot_{i}"] = raw.wxyz[:, i]
    table["opacity"] = 1
    table["f_rest_1"] = 0.3
    PlyData([PlyElement.describe(table, "vertex")], byte_order="<").write(str(tmp_path / "a.ply"))
    source = open_sequence(tmp_path)
    np.testing.assert_allclose(source.rest.colors, raw.colors, atol=1e-5)
    assert any("colours depend on the view" in note for note in source.notes)


def test_another_head_in_between_is_refused(tmp_path: Path, tiny_gem: Gem) -> None:
    save_ply_sequence([head(), tiny_gem.compose(tiny_gem.rest_coefficients)], tmp_path)
    with pytest.raises(ForeignFormatError, match=r"frame_000001.*6 splats, frame_000000.ply has 300"):
        adopt(open_sequence(tmp_path), "Mixed")
