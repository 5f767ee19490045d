"""What `reenact --resume` keeps of an earlier run, goes on with, and makes anew."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.library import DEMO_CLIP

from ..clips import VARIABLE, cut_clip, play, times

pytestmark = pytest.mark.skipif(not DEMO_CLIP.is_file(), reason=f"the demo clip is missing: {DEMO_CLIP}")


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    return cut_clip(tmp_path / "talk.mp4", VARIABLE)


def test_pngs_with_alpha_and_resuming_a_folder(tiny: Path, clip: Path, tmp_path: Path) -> None:
    out = tmp_path / "pngs"
    words = (clip, "-o", out, "--background", "transparent")
    assert play(tiny, *words) == 0
    files = sorted(out.glob("*.png"))
    assert len(files) == len(VARIABLE)
    image = cv2.imread(str(files[5]), cv2.IMREAD_UNCHANGED)
    assert image.shape == (64, 64, 4)
    assert image[0, 0, 3] == 0
    assert image[32, 32, 3] > 200
    kept, lost = files[3].read_bytes(), image
    files[3].write_bytes(b"mine")
    files[5].unlink()
    (out / "times.csv").unlink()
    assert play(tiny, *words, "--resume") == 0
    assert files[3].read_bytes() == b"mine" != kept
    assert np.array_equal(cv2.imread(str(files[5]), cv2.IMREAD_UNCHANGED), lost)
    assert len((out / "times.csv").read_text().splitlines()) == len(VARIABLE) + 1


def test_several_drivers_and_resuming_what_is_left(tiny: Path, clip: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.mp4"
    other.write_bytes(clip.read_bytes())
    broken = tmp_path / "broken.mp4"
    broken.write_text("no video")
    out, report = tmp_path / "all", tmp_path / "r.json"
    assert play(tiny, clip, broken, other, "-o", out) == ExitCode.INPUT
    assert sorted(file.name for file in out.iterdir()) == ["other.mp4", "talk.mp4"]
    before = (out / "talk.mp4").stat().st_mtime_ns
    (out / "other.mp4").unlink()
    assert play(tiny, clip, other, "-o", out, "--resume", "--report", report) == 0
    assert (out / "talk.mp4").stat().st_mtime_ns == before
    assert [run["status"] for run in json.loads(report.read_text())["runs"]] == ["kept", "done"]


def test_resuming_signs_what_a_kill_left_unsigned(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    out = tmp_path / "out.mp4"
    with monkeypatch.context() as patch:
        patch.setattr("gemheads.app.reenacting.reenact.open_signer", lambda: (None, ""))
        assert play(tiny, clip, "-o", out) == 0
    assert main(["verify", str(out)]) == ExitCode.UNSIGNED
    assert play(tiny, clip, "-o", out, "--resume") == 0
    assert main(["verify", str(out)]) == 0


def test_resuming_keeps_what_nobody_knows_and_signs_none_of_it(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    foreign = tmp_path / "foreign.mp4"
    foreign.write_bytes(clip.read_bytes())
    assert play(tiny, clip, "-o", foreign, "--resume") == 0
    assert "nothing in it says what it was made of; passed by" in capsys.readouterr().err
    assert foreign.read_bytes() == clip.read_bytes()


def test_resuming_makes_anew_what_is_of_other_settings(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.mp4"
    assert play(tiny, clip, "-o", out) == 0
    first = out.read_bytes()
    assert play(tiny, clip, "-o", out, "--resume") == 0
    assert out.read_bytes() == first
    other = cut_clip(tmp_path / "other.mp4", VARIABLE[:9])
    for words in ((clip, "--background", "green"), (other,)):
        before = out.read_bytes()
        assert play(tiny, *words, "-o", out, "--resume") == 0
        assert "is of another driver, avatar or settings; made anew" in capsys.readouterr().err
        assert out.read_bytes() != before
    assert len(times(out)) == 9


def test_resuming_whole_folders_makes_anew_what_is_of_other_settings(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "pngs"
    assert play(tiny, clip, "-o", out) == 0
    first = (out / "frame_000000.png").stat().st_mtime_ns
    assert play(tiny, clip, "-o", out, "--resume") == 0
    assert "pngs: already done" in capsys.readouterr().err
    assert (out / "frame_000000.png").stat().st_mtime_ns == first
    (out / "frame_000003.png").unlink()
    assert play(tiny, clip, "-o", out, "--resume") == 0
    assert "already done" not in capsys.readouterr().err
    assert (out / "frame_000003.png").is_file()
    assert (out / "frame_000000.png").stat().st_mtime_ns == first
    assert play(tiny, clip, "-o", out, "--background", "green", "--resume") == 0
    assert "is of another driver, avatar or settings; made anew" in capsys.readouterr().err
    assert (out / "frame_000000.png").stat().st_mtime_ns > first
    (out / ".made-of.png.json").unlink()
    assert play(tiny, clip, "-o", out, "--resume") == 0
    assert "says what it was made of; passed by" in capsys.readouterr().err


def test_resuming_makes_anew_what_had_another_picture_as_its_neutral(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames = cv2.VideoCapture(str(DEMO_CLIP))
    picture, out, report = tmp_path / "n.png", tmp_path / "out.mp4", tmp_path / "r.json"

    def status(named: Path | str) -> str:
        assert play(tiny, clip, "-o", out, "--neutral", f"image={named}", "--resume", "--report", report) == 0
        return json.loads(report.read_text())["runs"][0]["status"]

    cv2.imwrite(str(picture), frames.read()[1])
    assert status(picture) == "done"
    monkeypatch.chdir(tmp_path)
    assert status("n.png") == "kept"
    for _ in range(40):
        image = frames.read()[1]
    cv2.imwrite(str(picture), image)
    assert status(picture) == "done"
