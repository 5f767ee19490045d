import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.errors import InputError
from gemheads.app.performing.weights import SHIPPED, WeightsTrack, is_weights, load_weights, save_weights
from safetensors.numpy import save

TRACK = WeightsTrack(
    "three frames",
    Fraction(1, 30000),
    np.array([0, 1001, 2002], np.int64),
    np.linspace(0, 1, 156, dtype=np.float32).reshape(3, 52),
    np.zeros((3, 3), np.float32),
)


def test_what_is_saved_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "track.safetensors"
    save_weights(TRACK, path)
    read = load_weights(path)
    assert (read.name, read.time_base) == (TRACK.name, TRACK.time_base)
    for name in ("pts", "weights", "turn"):
        assert np.array_equal(getattr(read, name), getattr(TRACK, name))
    assert is_weights(path)


@pytest.mark.parametrize(
    "wrong",
    [
        {"pts": np.array([0, 5, 5], np.int64)},
        {"pts": np.zeros(0, np.int64), "weights": np.zeros((0, 52), np.float32), "turn": np.zeros((0, 3), np.float32)},
        {"weights": np.full((3, 52), 1.5, np.float32)},
        {"weights": np.full((3, 52), np.nan, np.float32)},
        {"weights": np.zeros((3, 51), np.float32)},
        {"weights": np.zeros((3, 52), np.float64)},
        {"turn": np.full((3, 3), 2.0, np.float32)},
        {"turn": np.full((3, 3), np.inf, np.float32)},
        {"name": ""},
        {"time_base": Fraction(-1, 30)},
    ],
)
def test_a_performance_that_is_none_is_refused_on_both_sides(wrong: dict, tmp_path: Path) -> None:
    path = tmp_path / "wrong.safetensors"
    track = replace(TRACK, **wrong)
    with pytest.raises(ValueError):  # noqa: PT011 (the words differ)
        save_weights(track, path)
    about = json.dumps({"version": 1, "name": track.name, "time_base": str(track.time_base)})
    path.write_bytes(
        save({"pts": track.pts, "weights": track.weights, "turn": track.turn}, {"gemheads-weights": about})
    )
    with pytest.raises(InputError, match=r"wrong\.safetensors"):
        load_weights(path)


@pytest.mark.parametrize(
    "content", [b"", b"\0" * 7, b"\xff" * 64, b"\x02\0\0\0\0\0\0\0{}", b"\x08\0\0\0\0\0\0\0" + b"[" * 8]
)
def test_bytes_that_are_no_file_are_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "garbage.safetensors"
    path.write_bytes(content)
    with pytest.raises(InputError, match="not a performance"):
        load_weights(path)


def test_another_version_and_extra_tensors_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "odd.safetensors"
    tensors = {"pts": TRACK.pts, "weights": TRACK.weights, "turn": TRACK.turn}
    path.write_bytes(save(tensors, {"gemheads-weights": json.dumps({"version": 2})}))
    with pytest.raises(InputError, match="version 1"):
        load_weights(path)
    path.write_bytes(save({**tensors, "more": TRACK.turn}, {"gemheads-weights": json.dumps({"version": 1})}))
    with pytest.raises(InputError, match="more"):
        load_weights(path)
    with pytest.raises(InputError, match="check the path"):
        load_weights(tmp_path / "absent.safetensors")


def test_the_demo_ships_and_moves_the_whole_face_in_a_circle() -> None:
    demo = load_weights(SHIPPED)
    assert SHIPPED.stat().st_size < 200_000
    assert len(demo.pts) * float(demo.time_base) * np.median(np.diff(demo.pts)) > 8
    from gemheads.models.arkit import NAMES

    strongest = dict(zip(NAMES, demo.weights.max(0), strict=True))
    for shape in ("jawOpen", "mouthSmileLeft", "mouthPucker", "eyeBlinkLeft", "browDownLeft"):
        assert strongest[shape] > 0.3, shape
    steps = np.abs(np.diff(demo.weights, axis=0)).max()
    assert np.abs(demo.weights[0] - demo.weights[-1]).max() <= steps
    assert np.linalg.norm(demo.turn[0] - demo.turn[-1]) < 0.05
