"""Tracks: made of a clip, and played."""

from collections.abc import Iterator
from fractions import Fraction
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.credentials.reading import read_credentials
from gemheads.app.errors import ExitCode
from gemheads.app.library import DEMO_CLIP
from gemheads.app.live import perform
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, load_track, save_track
from gemheads.models.gemfile import load_gem
from gemheads.models.wholefile import file_sha256

from ..clips import VARIABLE, pictures, play, sound, times

pytestmark = pytest.mark.skipif(not DEMO_CLIP.is_file(), reason=f"the demo clip is missing: {DEMO_CLIP}")


def write_track(path: Path, tiny: Path, frames: int) -> Path:
    """A track of the avatar at rest with the times of ``clip``, whose head turns and moves more and more."""
    gem = load_gem(tiny)
    poses = tuple(
        Pose(gem.rest_coefficients, np.float32([0, min(0.3 * i, 6), 0]), translation=np.float32([0.02 * i, 0, 0]))
        for i in range(frames)
    )
    pts = np.cumsum([2002, *[1001, 1500, 500, 1001] * 25])[:frames]
    save_track(Track("tiny", file_sha256(tiny), Fraction(1, 30000), Fraction(30), pts, poses), path)
    return path


def test_tracking_that_is_stopped_before_the_first_frame_says_so(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("gemheads.app.reenacting.tracking.perform", stopped)
    track = tmp_path / "t.safetensors"
    words = ["track", str(clip), "-o", str(track), "--avatar", str(tiny), "--driver", "baseline"]
    assert main(words) == ExitCode.INTERRUPTED
    assert not track.exists()
    assert "stopped before the first frame; nothing was written" in capsys.readouterr().err


def test_tracking_that_is_stopped_leaves_an_older_track_as_it_is(
    tiny: Path, clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(*words: Any) -> Iterator[Any]:
        yield from islice(perform(*words), 3)
        raise KeyboardInterrupt

    monkeypatch.setattr("gemheads.app.reenacting.tracking.perform", stopped)
    track = tmp_path / "t.safetensors"
    track.write_bytes(b"of before")
    words = ["track", str(clip), "-o", str(track), "--avatar", str(tiny), "--driver", "baseline"]
    assert main(words) == ExitCode.INTERRUPTED
    assert track.read_bytes() == b"of before"
    left = tmp_path / "t.partial.safetensors"
    assert f"{left}: stopped after 3 frames, 0 of them without a face" in capsys.readouterr().err
    assert load_track(left).frame_count == 3


def test_a_track_plays_as_the_video_did(tiny: Path, clip: Path, tmp_path: Path) -> None:
    track, out, again, beside = (tmp_path / name for name in ("t.safetensors", "a.mp4", "b.mp4", "c.mp4"))
    words = ["track", str(clip), "-o", str(track), "--avatar", str(tiny), "--driver", "baseline"]
    assert main(words) == 0
    assert play(tiny, clip, "-o", out) == 0
    assert play(tiny, "--track", track, "-o", again) == 0
    assert times(again) == times(out)
    assert np.array_equal(pictures(again), pictures(out))
    assert play(tiny, clip, "--track", track, "-o", beside, "--side-by-side", "--name-driver") == 0
    assert sound(beside) == sound(clip)
    if find_spec("c2pa"):
        said = read_credentials(beside)
        assert said.ours is not None
        assert said.source_type == "compositeWithTrainedAlgorithmicMedia"
        assert said.ours["along"] == {"kind": "video", "sha256": file_sha256(clip), "name": "talk.mp4"}
    assert main(["export", str(tiny), "-o", str(tmp_path / "ply"), "--track", str(track)]) == 0
    assert len(list((tmp_path / "ply").glob("frame_*.ply"))) == len(VARIABLE)


def test_a_track_keeps_the_head_still_where_that_is_asked_for(tiny: Path, tmp_path: Path) -> None:
    track = write_track(tmp_path / "t.safetensors", tiny, 3)
    for name, words in (("turned.mp4", ()), ("still.mp4", ("--no-head-pose",))):
        assert play(tiny, "--track", track, "-o", tmp_path / name, *words) == 0
    turned, still = pictures(tmp_path / "turned.mp4"), pictures(tmp_path / "still.mp4")
    assert np.abs(turned[0].astype(int) - turned[2]).max() > 20
    assert np.abs(still[0].astype(int) - still[2]).max() < 5


@pytest.mark.parametrize(("frames", "said"), [(3, "goes on after the 3 frames"), (99, "ends before the 99 frames")])
def test_a_track_of_another_length_than_the_driver_is_told(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], frames: int, said: str
) -> None:
    track = write_track(tmp_path / "t.safetensors", tiny, frames)
    assert play(tiny, clip, "--track", track, "-o", tmp_path / "out.mp4") == ExitCode.INPUT
    assert f"talk.mp4: {said} of the track" in capsys.readouterr().err
    assert not (tmp_path / "out.mp4").exists()


def test_another_video_of_the_same_times_beside_a_track_is_told(
    tiny: Path, clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    track = tmp_path / "t.safetensors"
    words = ["track", str(clip), "-o", str(track), "--avatar", str(tiny), "--driver", "baseline"]
    assert main(words) == 0
    stranger = tmp_path / "stranger.mp4"
    stranger.write_bytes(clip.read_bytes() + b"\0\0\0\x08free")
    told = f"stranger.mp4: is not the file that {track} was made of; if it does not show the same, give the one"
    for driver, says in ((clip, False), (stranger, True)):
        assert play(tiny, driver, "--track", track, "-o", tmp_path / "out.mp4") == 0
        assert (told in capsys.readouterr().err) is says
