"""PLY files as other programs read them; plyfile is the oracle."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.gem import Gem
from gemheads.models.ply import load_ply, save_ply, save_ply_sequence
from gemheads.render.gaussians import RawGaussians
from plyfile import PlyData

NAMES = "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()


@pytest.fixture
def raw(tiny_gem: Gem) -> RawGaussians:
    return tiny_gem.compose(tiny_gem.rest_coefficients)


def test_another_reader_sees_the_splats(raw: RawGaussians, tmp_path: Path) -> None:
    save_ply(raw, tmp_path / "a.ply")
    ply = PlyData.read(str(tmp_path / "a.ply"))
    vertex = ply["vertex"]
    assert not ply.text
    assert ply.byte_order == "<"
    assert [p.name for p in vertex.properties] == NAMES
    assert {p.val_dtype for p in vertex.properties} == {"f4"}
    table = np.stack([vertex[name] for name in NAMES], 1)
    np.testing.assert_array_equal(table[:, :3], raw.positions)
    np.testing.assert_array_equal(table[:, 3:6], 0)
    np.testing.assert_allclose(0.5 + 0.28209479177387814 * table[:, 6:9], raw.colors, atol=1e-6)
    np.testing.assert_array_equal(table[:, 9], raw.opacity_logits)
    np.testing.assert_array_equal(table[:, 10:13], raw.log_scales)
    np.testing.assert_allclose(np.linalg.norm(table[:, 13:], axis=1), 1, rtol=1e-6)
    alignment = (table[:, 13:] * raw.wxyz).sum(1) / np.linalg.norm(raw.wxyz, axis=1)
    np.testing.assert_allclose(alignment, 1, rtol=1e-6)


def test_what_was_saved_is_read(raw: RawGaussians, tmp_path: Path) -> None:
    save_ply(raw, tmp_path / "a.ply")
    again = load_ply(tmp_path / "a.ply")
    np.testing.assert_array_equal(again.positions, raw.positions)
    np.testing.assert_array_equal(again.log_scales, raw.log_scales)
    np.testing.assert_array_equal(again.opacity_logits, raw.opacity_logits)
    np.testing.assert_allclose(again.colors, raw.colors, atol=1e-6)
    assert again.positions.flags.c_contiguous


def test_a_sequence_is_numbered(raw: RawGaussians, tmp_path: Path) -> None:
    save_ply_sequence((raw for _ in range(3)), tmp_path / "new" / "folder")
    names = sorted(path.name for path in (tmp_path / "new" / "folder").iterdir())
    assert names == ["frame_000000.ply", "frame_000001.ply", "frame_000002.ply"]
    save_ply_sequence([], tmp_path / "empty")
    assert not list((tmp_path / "empty").iterdir())


def test_a_save_that_fails_leaves_nothing(raw: RawGaussians, tmp_path: Path) -> None:
    (tmp_path / "a.ply").mkdir()
    with pytest.raises(OSError, match="directory"):
        save_ply(raw, tmp_path / "a.ply")
    assert [path.name for path in tmp_path.iterdir()] == ["a.ply"]


@pytest.mark.parametrize(
    "edit",
    [
        lambda content: content[:-1],
        lambda content: content + b"\0",
        lambda content: b"",
        lambda content: content[:40],
        lambda content: content.replace(b"vertex 6", b"vertex 7"),
        lambda content: content.replace(b"vertex 6", b"vertex 99999999999999"),
        lambda content: content.replace(b"vertex 6", b"vertex -6"),
        lambda content: content.replace(b"binary_little_endian", b"ascii"),
        lambda content: content.replace(b"float rot_3", b"uchar rot_3"),
    ],
)
def test_other_files_are_refused(raw: RawGaussians, tmp_path: Path, edit) -> None:
    path = tmp_path / "a.ply"
    save_ply(raw, path)
    path.write_bytes(edit(path.read_bytes()))
    with pytest.raises(ValueError, match=r"a\.ply: .*; export it again"):
        load_ply(path)
