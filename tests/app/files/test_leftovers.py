import hashlib
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode, OutputError
from gemheads.app.files.leftovers import take_over
from gemheads.app.files.sources import read_image
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, save_track
from gemheads.models.gemfile import load_gem

MADE_OF = {"avatar": "ab", "size": "64x64"}


def leave(folder: Path, *names: str) -> None:
    """What a run of MADE_OF left."""
    take_over(folder, ".png", MADE_OF)
    for name in names:
        (folder / name).write_bytes(b"mine")


def seen(folder: Path) -> list[str]:
    return sorted(file.name for file in folder.iterdir() if not file.name.startswith("."))


def test_the_same_run_goes_on(tmp_path: Path) -> None:
    leave(tmp_path, "frame_000000.png", "times.csv")
    assert take_over(tmp_path, ".png", dict(MADE_OF), resume=True, index=["times.csv"]) == (True, "")
    assert seen(tmp_path) == ["frame_000000.png", "times.csv"]


def test_another_run_begins_anew_and_says_what_differs(tmp_path: Path) -> None:
    leave(tmp_path, "frame_000000.png", "frame_1000000.png", "times.csv")
    kept, said = take_over(tmp_path, ".png", {**MADE_OF, "size": "128x128"}, resume=True, index=["times.csv"])
    assert not kept
    assert said == f"{tmp_path}: the files that were there are of another size; begun anew"
    assert seen(tmp_path) == []
    assert take_over(tmp_path, ".png", MADE_OF, resume=True) == (False, "")  # nothing was lost that could be told


def test_without_resume_nothing_is_kept_but_what_is_no_frame(tmp_path: Path) -> None:
    leave(tmp_path, "frame_000007.png", "frame_7.png", "frame_000007.ply", "cover.png")
    assert take_over(tmp_path, ".png", MADE_OF) == (False, "")
    assert seen(tmp_path) == ["cover.png", "frame_000007.ply", "frame_7.png"]


@pytest.mark.parametrize("resume", [False, True])
def test_frames_that_nobody_noted_are_never_removed(tmp_path: Path, resume: bool) -> None:
    (tmp_path / "frame_000001.png").write_bytes(b"mine")
    (tmp_path / "times.csv").touch()
    with pytest.raises(OutputError, match=r"holds frame_000001\.png, and nothing says which run made it; choose"):
        take_over(tmp_path, ".png", MADE_OF, resume, ["times.csv"])
    assert seen(tmp_path) == ["frame_000001.png", "times.csv"]


@pytest.mark.parametrize("resume", [False, True])
def test_a_list_that_nobody_noted_is_never_removed(tmp_path: Path, resume: bool) -> None:
    (tmp_path / "times.csv").write_bytes(b"mine")
    with pytest.raises(OutputError, match=r"holds times\.csv, and nothing says which run made it; choose .* rename it"):
        take_over(tmp_path, ".png", MADE_OF, resume, ["times.csv"])
    assert (tmp_path / "times.csv").read_bytes() == b"mine"


def test_what_a_killed_run_had_begun_to_write_is_removed(tmp_path: Path) -> None:
    torn = ".frame_000001.png.4711-140072.partial"
    leave(tmp_path, "frame_000000.png", torn, ".frame_1.png.4711.partial", ".cover.partial")
    assert take_over(tmp_path, ".png", MADE_OF, resume=True) == (True, "")
    hidden = {file.name for file in tmp_path.iterdir()}
    assert hidden == {"frame_000000.png", ".made-of.png.json", ".frame_1.png.4711.partial", ".cover.partial"}


def test_a_broken_note_is_another_run(tmp_path: Path) -> None:
    leave(tmp_path, "frame_000000.png")
    (tmp_path / ".made-of.png.json").write_text('{"avatar": ')
    assert not take_over(tmp_path, ".png", MADE_OF, resume=True)[0]
    assert seen(tmp_path) == []


Act = Callable[[int], Path]


@pytest.fixture
def act(tiny: Path, tmp_path: Path) -> Act:
    """Makes a track of so many frames."""

    def make(frames: int) -> Path:
        pose = Pose(load_gem(tiny).rest_coefficients, np.zeros(3, np.float32))
        sha256 = hashlib.sha256(tiny.read_bytes()).hexdigest()
        path = tmp_path / f"{frames}.safetensors"
        save_track(Track("tiny", sha256, Fraction(1, 30), Fraction(30), np.arange(frames), (pose,) * frames), path)
        return path

    return make


def play(tiny: Path, track: Path, out: Path, *more: str) -> int:
    words = ["reenact", "--track", track, "-o", out, "--avatar", tiny, "--engine", "software", *more]
    return main([str(word) for word in words])


def test_a_folder_of_pictures_is_of_one_run(
    tiny: Path, act: Act, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert play(tiny, act(4), out, "--size", "32x32") == ExitCode.OK
    for missing in ("frame_000001.png", "times.csv"):  # as if it had been stopped
        (out / missing).unlink()
    capsys.readouterr()
    assert play(tiny, act(4), out, "--size", "48x48", "--resume") == ExitCode.OK
    assert "of another size; begun anew" in capsys.readouterr().err
    assert {read_image(file).shape for file in out.glob("*.png")} == {(48, 48, 3)}
    assert play(tiny, act(2), out, "--size", "48x48") == ExitCode.OK
    assert seen(out) == ["frame_000000.png", "frame_000001.png", "times.csv"]


def test_a_folder_of_splats_is_of_one_track(tiny: Path, act: Act, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for frames in (3, 2):
        assert main(["export", str(tiny), "--track", str(act(frames)), "-o", str(out)]) == ExitCode.OK
    assert seen(out) == ["frame_000000.ply", "frame_000001.ply"]
