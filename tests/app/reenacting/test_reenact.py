"""The whole way, on a second of the clip that ships: video in, video out."""

import errno
import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.files.crop import Crop
from gemheads.app.files.sources import Source, open_source
from gemheads.app.library import DEMO_CLIP
from gemheads.models.gemfile import load_gem, save_gem
from waiting import eventually

from ..clips import SIZE, VARIABLE, cut_clip, pictures, play, sound, times
from ..conftest import make_sound_unknown

pytestmark = pytest.mark.skipif(not DEMO_CLIP.is_file(), reason=f"the demo clip is missing: {DEMO_CLIP}")


def test_times_are_exact_sound_is_copied_and_the_report_tells(tiny: Path, clip: Path, tmp_path: Path) -> None:
    out, report = tmp_path / "out.mp4", tmp_path / "report.json"
    assert play(tiny, clip, "-o", out, "--report", report) == 0
    assert times(out) == times(clip) == [Fraction(t, 30000) for t in VARIABLE]
    assert sound(out) == sound(clip)
    told = json.loads(report.read_text())
    run = told["runs"][0]
    assert (run["status"], run["frames"], run["losses"]) == ("done", len(VARIABLE), 0)
    assert run["neutral"]["why"]
    assert {"neutral", "track", "compose", "draw", "over"} <= set(run["stages_ms"])
    assert told["settings"]["engine"]["used"] == "software"
    assert told["versions"]["gemheads"]


def test_a_second_face_is_told_and_what_to_do_if_it_is_the_wrong_one(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    both, one = tmp_path / "both", tmp_path / "one"
    for number, frame in enumerate(islice(open_source(str(clip)).frames(), 4)):
        for folder, picture in ((one, frame.rgb), (both, np.concatenate([frame.rgb[:, ::-1], frame.rgb], axis=1))):
            folder.mkdir(exist_ok=True)
            cv2.imwrite(str(folder / f"{number}.png"), picture[..., ::-1])
    assert play(tiny, both, "-o", tmp_path / "both.mp4") == 0
    told = capsys.readouterr().err
    assert f"{both}: several faces in 100% of the frames, of which one is followed: if it is the wrong one" in told
    assert told.count("several faces") == 1
    assert play(tiny, one, "-o", tmp_path / "one.mp4", "--side-by-side") == 0
    crop = ("--crop", "right", "--side-by-side", "--report", tmp_path / "r.json")
    assert play(tiny, both, "-o", tmp_path / "right.mp4", *crop) == 0
    assert "several faces" not in capsys.readouterr().err
    np.testing.assert_array_equal(pictures(tmp_path / "right.mp4"), pictures(tmp_path / "one.mp4"))
    assert json.loads((tmp_path / "r.json").read_text())["settings"]["crop"] == "50,0,50,100"


def test_what_was_made_of_another_part_is_made_anew(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for part, said in (("whole", ""), ("10,0,80,100", "made anew"), ("10,0,80,100", "already done")):
        assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--crop", part, "--resume") == 0
        assert said in capsys.readouterr().err


def test_a_part_too_small_for_a_face_is_refused(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--crop", "0,0,1,50") == ExitCode.INPUT
    assert "--crop 0,0,1,50 leaves 5x256 pixels; give a part of at least 16" in capsys.readouterr().err


def test_the_same_clip_gives_the_same_pictures(tiny: Path, clip: Path, tmp_path: Path) -> None:
    for name in ("a.mp4", "b.mp4"):
        assert play(tiny, clip, "-o", tmp_path / name) == 0
    assert np.array_equal(pictures(tmp_path / "a.mp4"), pictures(tmp_path / "b.mp4"))


def test_the_driver_stands_beside_the_avatar_when_asked(tiny: Path, clip: Path, tmp_path: Path) -> None:
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--side-by-side", "--background", "white") == 0
    pair, driver = pictures(tmp_path / "out.mp4"), pictures(clip)
    assert pair.shape[2] > 64
    left = cv2.resize(driver[3], (pair.shape[2] - 64, 64), interpolation=cv2.INTER_AREA)
    assert np.abs(pair[3, :, :-64].astype(int) - left).mean() < 6
    assert pair[3, :6, -58:].mean() > 245  # white above the avatar


def test_a_lost_face_is_counted(tiny: Path, tmp_path: Path) -> None:
    clip = cut_clip(tmp_path / "gap.mp4", tuple(range(0, 30000, 1000)), hidden=range(8, 24))
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--report", tmp_path / "r.json") == 0
    run = json.loads((tmp_path / "r.json").read_text())["runs"][0]
    assert (run["frames"], run["losses"], run["frames_without_face"]) == (30, 1, 16)


def test_a_driver_is_not_written_over_by_the_result_of_another(tiny: Path, clip: Path, tmp_path: Path) -> None:
    (tmp_path / "x").mkdir()
    other = clip.rename(tmp_path / "x" / clip.name)
    clip.write_bytes(other.read_bytes())
    assert play(tiny, other, clip, "-o", tmp_path) == ExitCode.USAGE
    assert clip.read_bytes() == other.read_bytes()
    assert main(["track", str(clip), "-o", str(clip), "--avatar", str(tiny)]) == ExitCode.USAGE
    assert clip.read_bytes() == other.read_bytes()


def test_several_drivers_write_over_no_video_that_no_run_made(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = tmp_path / "own"
    own.mkdir()
    drivers = [clip.rename(own / "talk.mov"), own / "b.mov"]
    drivers[1].write_bytes(drivers[0].read_bytes())
    (precious := own / "talk.mp4").write_bytes(drivers[0].read_bytes())
    assert play(tiny, *drivers, "-o", own) == ExitCode.OUTPUT
    assert "talk.mp4: is there already, and nothing in it says that a run made it" in capsys.readouterr().err
    assert precious.read_bytes() == drivers[0].read_bytes()
    precious.unlink()
    for _ in range(2):  # results are written over by results
        assert play(tiny, *drivers, "-o", own) == ExitCode.OK


def test_a_report_names_what_was_not_begun_and_why_results_are_not_signed(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(path: str, rate: Fraction, crop: Crop) -> Source:
        if "other" in path:
            raise KeyboardInterrupt
        return open_source(path, rate, crop=crop)

    monkeypatch.setattr("gemheads.app.reenacting.reenact.open_signer", lambda: (None, "the key is damaged"))
    monkeypatch.setattr("gemheads.app.reenacting.onedriver.open_source", stopped)
    others = [tmp_path / "other.mp4", tmp_path / "third.mp4"]
    for other in others:
        other.write_bytes(clip.read_bytes())
    words = (clip, *others, "-o", tmp_path / "all", "--report", tmp_path / "r.json")
    assert play(tiny, *words) == ExitCode.INTERRUPTED
    runs = json.loads((tmp_path / "r.json").read_text())["runs"]
    assert [run["status"] for run in runs] == ["done", "interrupted", "not begun"]
    assert [run["credentials"] for run in runs] == ["the key is damaged", "", ""]


def test_a_rate_is_for_pictures(tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--rate", "10") == ExitCode.USAGE
    assert "--rate: does nothing for videos and tracks, which have their own times" in capsys.readouterr().err
    track = tmp_path / "t.safetensors"
    assert main(["track", str(clip), "-o", str(track), "--avatar", str(tiny), "--rate", "10"]) == ExitCode.USAGE
    shots = tmp_path / "shots"
    shots.mkdir()
    for number, shot in enumerate(pictures(clip)[:2]):
        cv2.imwrite(str(shots / f"{number}.png"), shot[..., ::-1])
    assert play(tiny, shots, "-o", tmp_path / "out.mp4", "--rate", "10") == 0
    assert times(tmp_path / "out.mp4") == [0, Fraction(1, 10)]


def test_what_nobody_foresaw_in_one_driver_does_not_stop_the_others(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def odd(path: str, rate: Fraction, crop: Crop) -> Source:
        if "talk" in path:
            raise AttributeError("no name")
        return open_source(path, rate, crop=crop)

    monkeypatch.setattr("gemheads.app.reenacting.onedriver.open_source", odd)
    other = tmp_path / "other.mp4"
    other.write_bytes(clip.read_bytes())
    words = (clip, other, "-o", tmp_path / "all", "--report", tmp_path / "r.json")
    assert play(tiny, *words) == ExitCode.UNEXPECTED
    assert "talk.mp4: unexpected AttributeError: no name" in capsys.readouterr().err
    assert [run["status"] for run in json.loads((tmp_path / "r.json").read_text())["runs"]] == ["failed", "done"]
    with pytest.raises(AttributeError):
        play(tiny, *words, "--resume", "--debug")


def test_sound_that_cannot_be_read_is_told_and_left_out(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make_sound_unknown(clip)
    assert play(tiny, clip, "-o", tmp_path / "out.mp4") == 0
    assert "talk.mp4: its sound is of a kind that cannot be read here" in capsys.readouterr().err
    assert times(tmp_path / "out.mp4") == times(clip)


def test_neutral_by_picture_by_frame_and_by_time(tiny: Path, clip: Path, tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "rest.png"), pictures(clip)[0][..., ::-1])
    for rule, code in (
        ("first", 0),
        ("frame=3", 0),
        ("time=0.2", 0),
        (f"image={tmp_path / 'rest.png'}", 0),
        ("frame=9999", ExitCode.INPUT),
        (f"image={tmp_path / 'none.png'}", ExitCode.INPUT),
    ):
        assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--neutral", rule) == code, rule


def test_what_shows_nobody_is_no_result(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The neutral is known, so that only the end tells; it does so each time, and leaves what was there before."""
    cv2.imwrite(str(tmp_path / "rest.png"), pictures(clip)[0][..., ::-1])
    empty, out = cut_clip(tmp_path / "empty.mp4", VARIABLE, range(len(VARIABLE))), tmp_path / "out.mp4"
    out.write_bytes(b"of before")
    words = (empty, "-o", out, "--neutral", f"image={tmp_path / 'rest.png'}")
    assert play(tiny, *words) == ExitCode.NO_FACE
    assert f"no face in any frame; {tmp_path / 'out.partial.mp4'} shows the avatar at rest" in capsys.readouterr().err
    assert out.read_bytes() == b"of before"
    out.unlink()
    assert play(tiny, *words, "--resume") == ExitCode.NO_FACE
    assert not out.exists()


def test_a_contact_sheet_only_where_asked_for(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert play(tiny, clip, "-o", tmp_path / "out.mp4") == 0
    assert "--neutral-sheet FILE.png shows the best" in capsys.readouterr().err
    assert not list(tmp_path.glob("*.png"))
    sheet = tmp_path / "new" / "sheet.png"
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--neutral-sheet", sheet) == 0
    assert str(sheet) in capsys.readouterr().err
    assert min(cv2.imread(str(sheet)).shape[:2]) > 250
    other = tmp_path / "other.mp4"
    other.write_bytes(clip.read_bytes())
    assert play(tiny, clip, other, "-o", tmp_path / "all", "--neutral-sheet", tmp_path / "sheets") == 0
    assert sorted(file.name for file in (tmp_path / "sheets").iterdir()) == ["other.png", "talk.png"]
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--neutral-sheet", tmp_path / "sheets") == ExitCode.OUTPUT
    assert play(tiny, clip, "-o", tmp_path / "out.mp4", "--neutral-sheet", tmp_path / "a.jpg") == ExitCode.USAGE


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal")
def test_ctrl_c_leaves_a_video_that_plays(tiny: Path, tmp_path: Path) -> None:
    clip = cut_clip(tmp_path / "long.mp4", tuple(range(0, 90000, 1000)))
    folder = tmp_path / "clips"
    folder.mkdir()
    shots = pictures(clip)
    for copy in range(20):  # long enough to be interrupted on any machine
        for i, shot in enumerate(shots):
            cv2.imwrite(str(folder / f"{copy * len(shots) + i}.jpg"), cv2.resize(shot, (320, 320)))
    out = tmp_path / "out.mp4"
    words = ["reenact", str(folder), "-o", str(out), "--avatar", str(tiny), "--driver", "baseline", *SIZE]
    program = subprocess.Popen(
        [sys.executable, "-m", "gemheads.app.cli", *words], stderr=subprocess.PIPE, text=True, env={**os.environ}
    )
    partial = tmp_path / "out.partial.mp4"

    def begun() -> bool:
        assert program.poll() is None, program.communicate()
        return partial.exists() and partial.stat().st_size > 2000

    eventually(begun, 60)
    program.send_signal(signal.SIGINT)
    _, said = program.communicate(timeout=60)
    assert program.returncode == ExitCode.INTERRUPTED, said
    assert "what is there can be played" in said
    assert not out.exists()
    assert 5 < len(times(partial)) < 20 * len(shots)


def test_a_result_is_badged_and_signed_and_says_whose_face_it_is(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    badged, bare, report = tmp_path / "badged.mp4", tmp_path / "bare.mp4", tmp_path / "report.json"
    assert play(tiny, clip, "-o", badged) == 0
    assert "tiny: licence CC0; consent: synthetic" in capsys.readouterr().err
    why = "drawn for this test alone"
    assert play(tiny, clip, "-o", bare, "--no-badge", why, "--name-driver", "--report", report) == 0
    told = json.loads(report.read_text())
    assert told["settings"]["badge"] == why
    assert told["settings"]["avatar"]["consent"] == "synthetic"
    assert told["runs"][0]["credentials"] == "signed"
    differs = np.abs(pictures(badged).astype(int) - pictures(bare)).max(-1) > 60
    rows, columns = np.nonzero(differs.any(0))
    assert rows.min() > 40  # of 64, and compression smears a little
    assert len(np.unique(columns)) > 30
    assert differs.any((1, 2)).all()
    capsys.readouterr()
    assert main(["verify", str(bare)]) == 0
    said = capsys.readouterr().out
    assert f"left out: {why}" in said
    assert "video, talk.mp4, sha256 " in said
    assert main(["verify", str(badged)]) == 0
    said = capsys.readouterr().out
    assert "talk" not in said
    assert "Badge        drawn" in said


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("",), ExitCode.USAGE, "an empty word follows"),
        (("talk.mp4", "--report", "out.mp4"), ExitCode.USAGE, "two results would have this name"),
        (("talk.mp4", "--neutral-sheet", "out.mp4"), ExitCode.USAGE, "two results would have this name"),
        (("talk.mp4", "--report", "folder"), ExitCode.OUTPUT, "folder: is a folder; name a file"),
    ],
)
def test_what_cannot_be_is_told_before_anything_is_drawn(
    words: tuple[str, ...],
    code: ExitCode,
    said: str,
    tiny: Path,
    clip: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(clip.parent)
    Path("folder").mkdir()
    assert play(tiny, *words, "-o", "out.mp4") == code
    assert said in capsys.readouterr().err
    assert not Path("out.mp4").exists()


def test_an_avatar_without_consent_says_so_each_time(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    nobody = tmp_path / "nobody.gem"
    save_gem(replace(load_gem(tiny), about={}), nobody)
    for name in ("a.mp4", "b.mp4"):
        assert play(nobody, clip, "-o", tmp_path / name) == 0
        assert "tiny: licence not stated; no consent recorded" in capsys.readouterr().err


def test_a_full_disk_that_is_not_the_results_is_said_plainly(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(path: str, rate: Fraction, crop: Crop) -> Source:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("gemheads.app.reenacting.onedriver.open_source", full)
    assert play(tiny, clip, "-o", tmp_path / "out.mp4") == ExitCode.OUTPUT
    said = capsys.readouterr().err
    assert "talk.mp4: a disk is full: make room" in said
    assert "unexpected" not in said


def test_several_drivers_write_over_no_picture_that_no_run_made(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    other, sheets = tmp_path / "other.mp4", tmp_path / "sheets"
    other.write_bytes(clip.read_bytes())
    sheets.mkdir()
    cv2.imwrite(str(sheets / "other.png"), np.zeros((8, 8, 3), np.uint8))
    before = (sheets / "other.png").read_bytes()
    words = (clip, other, "-o", tmp_path / "all", "--neutral-sheet", sheets)
    for resume in ((), ("--resume",)):
        assert play(tiny, *words, *resume) == ExitCode.OUTPUT
        said = capsys.readouterr().err
        assert "other.png: is there already, and nothing in it says that a run made it; choose another folder" in said
        assert "--resume" not in said
    assert (sheets / "other.png").read_bytes() == before
    (sheets / "other.png").unlink()
    for _ in range(2):  # sheets are written over by sheets
        assert play(tiny, *words) == ExitCode.OK
    assert min(cv2.imread(str(sheets / "other.png")).shape[:2]) > 250
