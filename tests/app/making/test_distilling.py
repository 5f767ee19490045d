"""The command: somebody else's avatar in, one of our own out, that every other command takes."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.models.gemfile import load_gem
from gemheads.models.ply import save_ply_sequence
from gemheads.render.gaussians import RawGaussians
from gems import statue
from refusals import refused

STATED = ("--licence", "CC0-1.0", "--consent", "no person, a bent sheet")
"""Where these are missing, notes say so before anything else."""


@pytest.fixture
def folder(lam: Any, tmp_path: Path) -> Path:
    return lam.write(tmp_path / "lam")


def distil(*words: object) -> int:
    return main(["distill", *map(str, words), "--frames", "150"])


def test_what_is_distilled_can_be_shown_and_exported(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "sheet.gem"
    consent = "no person, a bent sheet"
    assert distil(folder, "-o", out, "--components", 12, "--consent", consent, "--author", "me") == 0
    said = capsys.readouterr()
    assert "opacity  does not move" in said.out
    assert re.search(r"position \d components keep 100.000% \(there is no more motion in it\)", said.out)
    assert "144 splats from 150 frames" in said.out
    assert "licence: not stated'; give --licence" in said.err
    assert "--consent" not in said.err
    assert "it has no browDownLeft" in said.err
    assert load_gem(out).name == "sheet"
    assert main(["info", str(out)]) == 0
    assert consent in capsys.readouterr().out
    assert main(["export", str(out), "-o", str(tmp_path / "a.ply"), "--set", "jawOpen=1"]) == 0
    assert main(["modes", str(out), "-o", str(tmp_path / "m.png"), "--engine", "software", "--size", "64x64"]) == 0


def test_the_same_source_gives_the_same_file(folder: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert distil(folder, "-o", tmp_path / f"{name}.gem", "--name", "One") == 0
    assert (tmp_path / "a.gem").read_bytes() == (tmp_path / "b.gem").read_bytes()


def test_a_folder_around_the_avatar_will_do(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "outer").mkdir()
    folder.rename(tmp_path / "outer" / "inner")
    assert distil(tmp_path / "outer", "-o", tmp_path / "a.gem", "--components", 3) == 0


def test_a_sequence_plays_its_own_frames(lam: Any, tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    parts = (lam.vertices - np.float32([0, 1.6, 0]), lam.splats.wxyz, lam.splats.log_scales)
    frames = [
        RawGaussians(
            parts[0] + 0.005 * rng.normal() * lam.shapes["jawOpen"],
            *parts[1:],
            lam.splats.opacity_logits,
            lam.splats.colors,
        )
        for _ in range(6)
    ]
    save_ply_sequence(frames, tmp_path / "frames")
    assert main(["distill", str(tmp_path / "frames"), "-o", str(tmp_path / "s.gem")]) == 0
    assert load_gem(tmp_path / "s.gem").arkit_weights is None


def test_a_single_frame_gives_an_avatar_that_nothing_drives_which_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_ply_sequence([statue().compose(np.zeros(0, np.float32))], tmp_path / "frames")
    assert main(["distill", str(tmp_path / "frames"), "-o", str(tmp_path / "s.gem")]) == 0
    assert "s.gem: does not move, so no face can drive it; give several frames that differ" in capsys.readouterr().err
    assert load_gem(tmp_path / "s.gem").coefficient_count == 0


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("lam", "-o", "a.ply"), ExitCode.USAGE, "an avatar's file is called .gem"),
        (("lam", "-o", "a.gem", "--components", "0"), ExitCode.USAGE, "choose from 1 to 512"),
        (("lam", "-o", "a.gem", "--components", "513"), ExitCode.USAGE, "choose from 1 to 512"),
        (("lam", "-o", "a.gem", "--scale", "0"), ExitCode.USAGE, "--scale 0.0: give the metres"),
        (("lam", "-o", "a.gem", "--scale", "nan"), ExitCode.USAGE, "--scale nan: give the metres"),
        (("lam", "-o", "a.gem", "--scale", "2"), ExitCode.USAGE, "--scale: does nothing for a LAM avatar"),
        (("lam", "-o", "a.gem", "--maps", "9999"), ExitCode.USAGE, "--maps: does nothing for a LAM avatar"),
        (("plys", "-o", "a.gem"), ExitCode.USAGE, "--frames: does nothing for PLY files"),
        (("nobody", "-o", "a.gem"), ExitCode.INPUT, "there is no PLY file; give a folder"),
        (("begun", "-o", "a.gem"), ExitCode.INPUT, "begun: is an unfinished capture, without transforms_train.json"),
        (("lam.zip", "-o", "a.gem"), ExitCode.USAGE, "unpack a .zip first"),
        ((".", "-o", "a.gem"), ExitCode.USAGE, "holds 2 avatars; give one"),
        (
            ("far", "-o", "a.gem"),
            ExitCode.USAGE,
            "far: holds avatars, but farther down; give one, such as far/down/lam",
        ),
        (("lam", "-o", "a.gem", "--author", "a" * 40_000), ExitCode.USAGE, "bytes, 32768 are kept; shorten them"),
        (("n" * 300, "-o", "a.gem"), ExitCode.INPUT, "cannot be opened (File name too long)"),
        (("steers.ply", "-o", "a.gem"), ExitCode.INPUT, "written as 'format  ]0;pwned  [2J 1.0'"),
        (("lam", "-o", "lam/skin.glb/a.gem"), ExitCode.OUTPUT, "cannot be written"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    lam: Any,
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    code: ExitCode,
    said: str,
) -> None:
    lam.write(tmp_path / "second")
    (tmp_path / "far" / "down").mkdir(parents=True)
    lam.write(tmp_path / "far" / "down" / "lam")
    (tmp_path / "plys").mkdir()
    (tmp_path / "begun" / "images").mkdir(parents=True)
    (tmp_path / "begun" / "template.npz").touch()
    (tmp_path / "steers.ply").write_text("ply\nformat \x1b]0;pwned\x07\x1b[2J 1.0\nelement vertex 1\nend_header\n")
    monkeypatch.chdir(tmp_path)
    frames = () if words[0] == "steers.ply" else ("--frames", "150")
    found, error = refused(capsys, "distill", *words, *frames, *STATED)
    assert found == code
    assert said in error
    assert not (tmp_path / "a.gem").exists()


def test_too_few_expressions(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["distill", str(folder), "-o", str(tmp_path / "a.gem"), "--frames", "7"]) == ExitCode.USAGE
    assert "--frames 7: choose from 150 to 5000" in capsys.readouterr().err
