"""Exported PLYs, read by somebody who trusts only the layout of the INRIA 3DGS code."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, save_track
from gemheads.models import arkit
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.models.wholefile import file_sha256
from gemheads.render.gaussians import Gaussians, activate
from gems import COMPONENTS, statue
from plyfile import PlyData
from refusals import refused

SH_C0 = 0.28209479177387814


def read_3dgs(path: Path) -> Gaussians:
    """Splats of a PLY; AssertionError for anything but the layout that the INRIA code writes, in its order.

    Harmonics of degree D take 3 (D + 1)^2 - 3 properties f_rest; a reader for D reads so many floats a splat.
    """
    ply = PlyData.read(str(path))
    assert not ply.text
    assert ply.byte_order == "<"
    assert [element.name for element in ply.elements] == ["vertex"]
    names = [p.name for p in ply["vertex"].properties]
    rest = [name for name in names if name.startswith("f_rest_")]
    assert len(rest) in (0, 9, 24, 45)
    assert names == [
        *("x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"),
        *(f"f_rest_{i}" for i in range(len(rest))),
        *("opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"),
    ]
    assert all(p.val_dtype == "f4" for p in ply["vertex"].properties)

    def columns(*wanted: str) -> np.ndarray:
        return np.stack([np.asarray(ply["vertex"][name]) for name in wanted], 1)

    wxyz = columns("rot_0", "rot_1", "rot_2", "rot_3")
    assert np.allclose(np.linalg.norm(wxyz, axis=1), 1, atol=1e-6)
    assert not columns("nx", "ny", "nz", *rest).any()
    return Gaussians(
        positions=columns("x", "y", "z"),
        wxyz=wxyz,
        scales=np.exp(columns("scale_0", "scale_1", "scale_2")),
        opacities=1 / (1 + np.exp(-columns("opacity")[:, 0])),
        colors=0.5 + SH_C0 * columns("f_dc_0", "f_dc_1", "f_dc_2"),
    )


@pytest.mark.parametrize("words", [(), ("--set", "jawOpen=0.8", "mouthSmileLeft=0.5")], ids=["at rest", "expression"])
def test_a_strict_reader_sees_the_splats_that_are_drawn(tiny: Path, tmp_path: Path, words: tuple[str, ...]) -> None:
    assert main(["export", str(tiny), "-o", str(tmp_path / "a.ply"), *words]) == 0
    gem = load_gem(tiny)
    weights = np.zeros(52)
    for word in words[1:]:
        name, value = word.split("=")
        weights[arkit.NAMES.index(name)] = float(value)
    drawn = activate(gem.compose(gem.clamped(gem.arkit_coefficients(weights))))
    read = read_3dgs(tmp_path / "a.ply")
    assert len(read.positions) == len(gem)
    for part in ("positions", "scales", "opacities", "colors"):
        np.testing.assert_allclose(getattr(read, part), getattr(drawn, part), rtol=1e-5, atol=1e-6, err_msg=part)
    turned_alike = np.abs((read.wxyz * drawn.wxyz).sum(1))  # q and -q are one rotation
    np.testing.assert_allclose(turned_alike, 1, atol=1e-5)


def test_a_track_that_goes_beyond_all_bounds_is_refused(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rest = load_gem(tiny).rest_coefficients
    for coefficients, said in ((rest + 3e30, "far beyond 3 sigma"), (rest, "turns the head by more")):
        pose = Pose(coefficients, np.full(3, 0 if coefficients is not rest else 9, np.float32))
        track = Track("tiny", file_sha256(tiny), Fraction(1, 30), Fraction(30), np.array([0]), (pose,))
        save_track(track, tmp_path / "t")
        words = ["export", str(tiny), "--track", str(tmp_path / "t"), "-o", str(tmp_path / "ply")]
        assert main(words) == ExitCode.INPUT
        assert said in capsys.readouterr().err


def test_a_track_of_another_avatar_is_refused_though_its_coefficients_are_as_many(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    track, pose = tmp_path / "t.safetensors", Pose(load_gem(tiny).rest_coefficients, np.zeros(3, np.float32))
    save_track(Track("mara", "ab" * 32, Fraction(1, 30), Fraction(30), np.array([0]), (pose,)), track)
    assert main(["export", str(tiny), "--track", str(track), "-o", str(tmp_path / "ply")]) == ExitCode.INPUT
    assert "was made for mara, not for" in capsys.readouterr().err
    assert not (tmp_path / "ply").exists()


@pytest.mark.parametrize("command", ["export", "modes"])
@pytest.mark.parametrize("name", ["my.gem", "my.obj", "my", "."])
def test_what_is_read_is_not_written_over(
    command: str, name: str, tiny: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    avatar = tmp_path / "my.gem"
    avatar.write_bytes(tiny.read_bytes())
    assert main([command, "my.gem", "-o", name]) == ExitCode.USAGE
    assert [file.name for file in tmp_path.iterdir()] == ["my.gem"]
    assert avatar.read_bytes() == tiny.read_bytes()


def test_an_avatar_called_like_a_result_is_kept(tiny: Path, tmp_path: Path) -> None:
    for command, name in (("export", "my.ply"), ("modes", "my.png")):
        (tmp_path / name).write_bytes(tiny.read_bytes())
        assert main([command, str(tmp_path / name), "-o", str(tmp_path / name)]) == ExitCode.USAGE
        assert (tmp_path / name).read_bytes() == tiny.read_bytes()


def test_components_that_an_avatar_lacks_are_refused(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_gem(statue(), tmp_path / "statue.gem")
    for avatar, cure in (
        (tiny, f"stores {COMPONENTS}; choose from 1 to {COMPONENTS}"),
        (tmp_path / "statue.gem", "stores 0; leave it out"),
    ):
        code, error = refused(capsys, "export", avatar, "-o", tmp_path / "a.ply", "--components", "99")
        assert code == ExitCode.USAGE
        assert cure in error


def test_a_track_is_not_put_into_a_folder_that_is_called_like_one_file(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "a.ply"
    assert main(["export", str(tiny), "--track", str(tmp_path / "t"), "-o", str(out)]) == ExitCode.USAGE
    assert "a.ply: with --track it is a folder of .ply files; name one" in capsys.readouterr().err
    assert not out.exists()
