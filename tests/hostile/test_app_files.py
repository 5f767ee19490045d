"""Tracks, performances, neutrals and cameras that want to do harm: one InputError each, soon."""

import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.errors import InputError
from gemheads.app.making.cameras import load_camera
from gemheads.app.performing.tracks import FORMAT, load_track
from gemheads.app.performing.weights import FORMAT as WEIGHTS_FORMAT
from gemheads.app.performing.weights import load_weights
from gemheads.app.person.profiles import load_profile, profile_path
from safetensors.numpy import save

DEEP = "[" * 100_000
ABOUT = {"version": 1, "avatar": "tiny", "avatar_sha256": "ab", "time_base": "1/30", "rate": "30"}


def refused(read: Callable[[Path], object], path: Path, content: bytes, said: str) -> None:
    path.write_bytes(content)
    began = time.process_time()
    with pytest.raises(InputError, match=said) as caught:
        read(path)
    assert time.process_time() - began < 1
    assert len(str(caught.value)) < len(str(path)) + 400
    assert "\n" not in str(caught.value)


def track(about: Any, **changed: np.ndarray) -> bytes:
    tensors = {
        "pts": np.arange(3),
        "coefficients": np.zeros((3, 5), np.float32),
        "turn": np.zeros((3, 3), np.float32),
        "phase": np.ones(3, np.uint8),
        "faces": np.ones(3, np.uint8),
        "clamped": np.zeros(3, np.float32),
    }
    return save({**tensors, **changed}, {FORMAT: about if isinstance(about, str) else json.dumps(about)})


def test_a_track_like_these_that_is_sound_opens(tmp_path: Path) -> None:
    (tmp_path / "t").write_bytes(track(ABOUT))
    assert load_track(tmp_path / "t").frame_count == 3


@pytest.mark.parametrize("field", ["time_base", "rate"])
@pytest.mark.parametrize("bomb", ["1e999999999", "1e-999999999", "9" * 5000, "1/" + "9" * 5000, 1e308, [1], None, "-1"])
def test_numbers_in_words_that_fill_the_memory(tmp_path: Path, field: str, bomb: object) -> None:
    """A Fraction of "1e999999999" is a number of 400 MB, and takes hours."""
    refused(load_track, tmp_path / "t", track({**ABOUT, field: bomb}), "no ratio")
    about = {"version": 1, "name": "nod", "time_base": bomb}
    moves = {"pts": np.arange(1), "weights": np.zeros((1, 52), np.float32), "turn": np.zeros((1, 3), np.float32)}
    refused(load_weights, tmp_path / "w", save(moves, {WEIGHTS_FORMAT: json.dumps(about)}), "no ratio")


def test_json_without_end(tmp_path: Path) -> None:
    refused(load_track, tmp_path / "t", track(DEEP), "nested without end|a header of")
    refused(load_camera, tmp_path / "c", DEEP.encode(), "not a camera")
    refused(load_track, tmp_path / "t", len(DEEP).to_bytes(8, "little") + DEEP.encode(), "not a track")


def test_a_header_of_megabytes(tmp_path: Path) -> None:
    """JSON takes twenty times its size while it is read."""
    header = b'{"a": [' + b"0," * 2**22 + b"0]}"
    refused(load_track, tmp_path / "t", len(header).to_bytes(8, "little") + header, "a header of 8388")


def test_times_whose_differences_wrap_around(tmp_path: Path) -> None:
    """2**63 - 1 and then -2**63: by their difference in 64 bits, one tick later."""
    pts = np.array([0, 2**63 - 1, -(2**63)])
    refused(load_track, tmp_path / "t", track(ABOUT, pts=pts), "times that do not rise")


def test_a_message_does_not_repeat_a_book(tmp_path: Path) -> None:
    matrix = [["x" * 50_000] * 4] * 4
    tree = {"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 4, "height": 4, "world_to_camera": matrix}
    refused(load_camera, tmp_path / "c", json.dumps(tree).encode(), "not a camera")


@pytest.mark.parametrize("side", [10**9, -1, 0, 1e400, "16384000"])
def test_a_camera_of_a_billion_pixels(tmp_path: Path, side: object) -> None:
    tree = {"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": side, "height": 4, "world_to_camera": np.eye(4).tolist()}
    refused(load_camera, tmp_path / "c", json.dumps(tree).encode(), "not a camera")


def test_the_name_of_a_camera_leads_into_no_other_folder(tmp_path: Path) -> None:
    for name in ("../../../etc/passwd", "/etc/passwd", "..\\..\\x", "a\0b", "", "." * 300):
        assert profile_path(name, tmp_path).parent == tmp_path
        assert load_profile(name, tmp_path) is None


@pytest.mark.parametrize("read", [load_track, load_weights, load_camera])
def test_pipes_folders_and_endless_devices_keep_nobody_waiting(read: Callable[[Path], object], tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path, Path("/dev/zero"), tmp_path / "none"):
        with pytest.raises(InputError, match=f"^{path}: "):
            read(path)
