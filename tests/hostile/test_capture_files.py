"""Captures of strangers: lists that lead out of the folder, archives that unpack to gigabytes."""

import io
import json
import os
import time
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.lib.format as npy
import pytest
from gemheads.models.captures.arrays import load_arrays
from gemheads.models.captures.layout import CaptureError
from gemheads.models.captures.transforms import read_transforms

FRAME = {
    "file_path": "images/0.png",
    "transform_matrix": np.eye(4).tolist(),
    **dict.fromkeys(("fl_x", "fl_y", "cx", "cy", "w", "h"), 32),
    "timestep_index": 0,
    "camera_index": 0,
}


def refused(read: Any, said: str) -> None:
    tracemalloc.start()
    began = time.process_time()
    try:
        with pytest.raises(CaptureError, match=said) as caught:
            read()
        assert tracemalloc.get_traced_memory()[1] < 1e7
    finally:
        tracemalloc.stop()
    assert time.process_time() - began < 2
    assert len(str(caught.value)) < 700
    assert "\n" not in str(caught.value)


def listed(folder: Path, **changed: Any) -> Path:
    path = folder / "transforms_train.json"
    path.write_text(json.dumps({"frames": [{**FRAME, **changed}]}))
    return path


def test_a_list_like_these_that_is_sound_is_read(tmp_path: Path) -> None:
    assert len(read_transforms(listed(tmp_path)).shots) == 1


@pytest.mark.parametrize("key", ["file_path", "fg_mask_path", "mesh_path"])
@pytest.mark.parametrize("out", ["/etc/passwd", "../../secret.png", "images/../../secret.png", "c:/secret.png"])
def test_a_path_out_of_the_folder(tmp_path: Path, key: str, out: str) -> None:
    path = listed(tmp_path, **{key: out})
    refused(lambda: read_transforms(path), "leaves the folder")


@pytest.mark.parametrize("text", ["[" * 200_000, '{"frames":' * 20_000, '{"frames": [' + "9" * 5000 + "]}"])
def test_json_without_end(tmp_path: Path, text: str) -> None:
    path = tmp_path / "transforms_train.json"
    path.write_text(text)
    refused(lambda: read_transforms(path), "nested too deeply|is no JSON|no object")


def test_a_name_as_long_as_a_book(tmp_path: Path) -> None:
    path = listed(tmp_path, file_path="x" * 100_000)
    refused(lambda: read_transforms(path), "no file_path")


def header(shape: tuple[int, ...], descr: object = "<f4") -> bytes:
    """The head of an array file; nothing is checked."""
    file = io.BytesIO()
    npy.write_array_header_1_0(file, {"descr": descr, "fortran_order": False, "shape": shape})
    return file.getvalue()


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (header((2**40,)) + bytes(64), "does not hold the numbers"),
        (header((2**62, 2**62)) + bytes(64), "does not hold the numbers"),
        (header((0, -1)), "does not hold the numbers|cannot be read"),
        (header((4,)) + bytes(15), "does not hold the numbers"),
        (header((2,), "|O") + bytes(16), "does not hold the numbers|cannot be read"),
        (header((4,)).replace(b"'<f4'", b"'<f4\n") + bytes(16), "cannot be read"),
        (header((4,))[:40] + b"(" * 60 + header((4,))[100:] + bytes(16), "cannot be read"),
        (b"\x93NUMPY\x09\0" + bytes(64), "no known version|cannot be read"),
        (b"no array at all", "cannot be read"),
        (bytes(2**22), "unpacks to 4 MiB"),
    ],
)
def test_arrays_that_lie(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: bytes, said: str) -> None:
    monkeypatch.setattr("gemheads.models.captures.arrays.MAX_BYTES", 2**20)  # so that a bomb is quickly made
    path = tmp_path / "template.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
        packed.writestr("vertices.npy", content)
    assert os.path.getsize(path) < 2**16
    refused(lambda: load_arrays(path, ("vertices",)), said)


def test_a_pickle_is_not_unpickled(tmp_path: Path) -> None:
    np.savez(tmp_path / "template.npz", vertices=np.array([{"a": 1}], object), allow_pickle=True)
    refused(lambda: load_arrays(tmp_path / "template.npz", ("vertices",)), "does not hold the numbers|cannot be read")


def test_arrays_that_are_sound_are_read(tmp_path: Path) -> None:
    values = np.asfortranarray(np.arange(12, dtype=np.float32).reshape(3, 4))
    np.savez(tmp_path / "template.npz", vertices=values)
    np.testing.assert_array_equal(load_arrays(tmp_path / "template.npz", ("vertices", "uv"))["vertices"], values)
