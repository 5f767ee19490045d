import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.errors import InputError, OutputError
from gemheads.app.performing.tracks import FORMAT, load_track, save_track
from safetensors.numpy import save_file
from tracks import TRACK


def test_a_track_comes_back_as_it_was(tmp_path: Path) -> None:
    save_track(replace(TRACK, driver_sha256="cd" * 32), tmp_path / "new" / "t.safetensors")
    back = load_track(tmp_path / "new" / "t.safetensors")
    assert (back.avatar, back.avatar_sha256) == (TRACK.avatar, TRACK.avatar_sha256)
    assert back.driver_sha256 == "cd" * 32
    assert (back.time_base, back.rate, back.frame_count) == (TRACK.time_base, TRACK.rate, 3)
    for (_, pose, pts), (_, pose0, pts0) in zip(back, TRACK, strict=True):
        assert pts == pts0
        assert np.array_equal(pose.coefficients, pose0.coefficients)
        assert np.array_equal(pose.turn, pose0.turn)
        assert np.array_equal(pose.translation, pose0.translation)
        assert (pose.phase, pose.faces, pose.clamped) == (pose0.phase, pose0.faces, pose0.clamped)
        assert pose.cut is pose0.cut


def test_a_track_of_before_does_not_say_of_what_it_was_made(tmp_path: Path) -> None:
    save_file(tensors(), tmp_path / "t", {FORMAT: json.dumps(ABOUT)})
    assert load_track(tmp_path / "t").driver_sha256 == ""


@pytest.mark.parametrize("rate", [Fraction(1035000000, 34505743), Fraction(2**31 - 1, 2**31 - 2)])
def test_it_is_of_any_rate_that_a_video_has(tmp_path: Path, rate: Fraction) -> None:
    """The average of a long phone video has a clock's ticks above, and the ticks that it lasted below."""
    save_track(replace(TRACK, rate=rate, time_base=Fraction(1, 10**9)), tmp_path / "t")
    assert load_track(tmp_path / "t").rate == rate


def tensors() -> dict[str, np.ndarray]:
    return {
        "pts": TRACK.pts,
        "coefficients": np.zeros((3, 5), np.float32),
        "turn": np.zeros((3, 3), np.float32),
        "translation": np.zeros((3, 3), np.float32),
        "phase": np.ones(3, np.uint8),
        "faces": np.ones(3, np.uint8),
        "clamped": np.zeros(3, np.float32),
        "cut": np.zeros(3, np.bool_),
    }


ABOUT = {"version": 3, "avatar": "tiny", "avatar_sha256": "ab", "time_base": "1/30", "rate": "30"}

HOSTILE = {
    "other version": ({}, {"version": 4}),
    "no version": ({}, {"version": [2]}),
    "version 1 with a translation": ({}, {"version": 1}),
    "version 2 with cuts": ({}, {"version": 2}),
    "cuts that are numbers": ({"cut": np.zeros(3, np.uint8)}, {}),
    "a head at infinity": ({"translation": np.full((3, 3), np.inf, np.float32)}, {}),
    "a head too far away": ({"translation": np.float32([[0, 0, 0], [0, -101, 0], [0, 0, 0]])}, {}),
    "a flat translation": ({"translation": np.zeros(3, np.float32)}, {}),
    "time base of zero": ({}, {"time_base": "0"}),
    "no number": ({}, {"rate": "fast"}),
    "division by zero": ({}, {"rate": "1/0"}),
    "NaN": ({"coefficients": np.full((3, 5), np.nan, np.float32)}, {}),
    "other length": ({"turn": np.zeros((2, 3), np.float32)}, {}),
    "other type": ({"turn": np.zeros((3, 3), np.float64)}, {}),
    "falling times": ({"pts": np.array([3, 2, 1])}, {}),
    "unknown phase": ({"phase": np.full(3, 9, np.uint8)}, {}),
    "a scalar": ({"coefficients": np.zeros((), np.float32)}, {}),
    "one tensor more": ({"extra": np.zeros(1, np.float32)}, {}),
    "no frames": (
        {name: values[:0] for name, values in tensors().items()},
        {},
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_no_track_is_refused_with_the_reason(tmp_path: Path, name: str) -> None:
    changed, about = HOSTILE[name]
    path = tmp_path / "t.safetensors"
    save_file({**tensors(), **changed}, path, {FORMAT: json.dumps({**ABOUT, **about})})
    with pytest.raises(InputError, match=r"t\.safetensors: not a track \(.+\); make one with"):
        load_track(path)


def test_what_is_whole_is_read_and_older_tracks_have_no_cuts_and_the_oldest_no_translation(tmp_path: Path) -> None:
    path, old = tmp_path / "t.safetensors", tensors()
    save_file(old, path, {FORMAT: json.dumps(ABOUT)})
    assert load_track(path).frame_count == 3
    del old["cut"]
    save_file(old, path, {FORMAT: json.dumps({**ABOUT, "version": 2})})
    assert not any(pose.cut for pose in load_track(path).poses)
    del old["translation"]
    save_file(old, path, {FORMAT: json.dumps({**ABOUT, "version": 1})})
    assert all(not pose.translation.any() for pose in load_track(path).poses)
    save_file(old, path, {FORMAT: json.dumps(ABOUT)})
    with pytest.raises(InputError, match=r"expected .*translation"):
        load_track(path)


@pytest.mark.parametrize("data", [b"", b"{}", b"\x08\0\0\0\0\0\0\0{}      ", b"\xff" * 100, b"\x80\x04K\x01."])
def test_what_is_no_safetensors_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "t").write_bytes(data)
    with pytest.raises(InputError, match="not a track"):
        load_track(tmp_path / "t")


def test_a_missing_track_and_a_folder_are_told(tmp_path: Path) -> None:
    for path in (tmp_path / "none", tmp_path):
        with pytest.raises(InputError, match=str(path)):
            load_track(path)


def test_a_place_that_cannot_be_written_is_told_and_nothing_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=r"cannot be written .* kept as"):
        save_track(replace(TRACK), tmp_path / "file" / "t")
    (kept,) = tmp_path.glob("*/t")
    assert load_track(kept).frame_count == TRACK.frame_count
