"""Captures of strangers: lists that lead out of the folder, archives that unpack to gigabytes."""

import io
import json
import os
import struct
import time
import tracemalloc
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.lib.format as npy
import pytest
from gemheads.models.captures.arrays import load_arrays
from gemheads.models.captures.layout import CaptureError
from gemheads.models.captures.meshes import read_template
from gemheads.models.captures.pictures import picture_size, read_pixels
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


@pytest.mark.parametrize("key", ["file_path", "fg_mask_path", "mesh_path"])
@pytest.mark.parametrize("place", [".", "./", "./."])
def test_a_path_that_is_the_folder(tmp_path: Path, key: str, place: str) -> None:
    path = listed(tmp_path, **{key: place})
    refused(lambda: read_transforms(path), "names no file")


@pytest.mark.parametrize("text", ["[" * 200_000, '{"frames":' * 20_000, '{"frames": [' + "9" * 5000 + "]}"])
def test_json_without_end(tmp_path: Path, text: str) -> None:
    path = tmp_path / "transforms_train.json"
    path.write_text(text)
    refused(lambda: read_transforms(path), "nested too deeply|is all lists|is no JSON|no object")


def png(width: int, height: int, *, claimed: int = 0) -> bytes:
    """A black picture, whose pixels claim to take so many bytes more than they do."""
    packed = zlib.compress(bytes(min(height, 16) * (1 + 3 * width)))
    pixels = chunk(b"IDAT", packed)
    body = (len(packed) + claimed).to_bytes(4, "big") + pixels[4:]
    shape = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", shape) + body + chunk(b"IEND", b"")


def chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


@pytest.mark.parametrize("claimed", [2**31 - 1000, 1])
def test_a_picture_that_claims_two_gigabytes(tmp_path: Path, claimed: int) -> None:
    (tmp_path / "sound.png").write_bytes(png(16, 16))
    assert not read_pixels(tmp_path / "sound.png", 16, 16).any()
    (tmp_path / "0.png").write_bytes(png(16, 16, claimed=claimed))
    refused(lambda: read_pixels(tmp_path / "0.png", 16, 16), "is broken")


def test_a_picture_of_more_pixels_than_are_decoded(tmp_path: Path) -> None:
    (tmp_path / "0.png").write_bytes(png(9000, 9000))
    refused(lambda: read_pixels(tmp_path / "0.png", 9000, 9000), "is broken")


def test_a_photograph_of_nothing_but_marks(tmp_path: Path) -> None:
    (tmp_path / "0.jpg").write_bytes(b"\xff\xd8" + b"\xff\xe0\0\2" * 2**22)
    refused(lambda: picture_size(tmp_path / "0.jpg"), "neither PNG nor JPEG")


def test_a_picture_that_is_a_pipe(tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("there are no pipes in folders here")
    os.mkfifo(tmp_path / "0.png")
    refused(lambda: picture_size(tmp_path / "0.png"), "no ordinary file")
    refused(lambda: read_pixels(tmp_path / "0.png", 16, 16), "no ordinary file")


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
def test_arrays_that_lie(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "template.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
        packed.writestr("vertices.npy", content)
    assert os.path.getsize(path) < 2**16
    refused(lambda: load_arrays(path, ("vertices",), 2**20), said)


def test_arrays_that_are_too_much_together(tmp_path: Path) -> None:
    names = ("vertices", "triangles", "uv", "uv_triangles", "neck_weights", "neck_pivot", "parts", "part_names")
    path = tmp_path / "template.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
        for name in names:
            packed.writestr(f"{name}.npy", header((2**21,)) + bytes(2**23 + 2**19))
    refused(lambda: read_template(path), "unpacks to 68 MiB")


def test_an_archive_of_a_hundred_thousand_files(tmp_path: Path) -> None:
    path = tmp_path / "template.npz"
    np.savez(path, vertices=np.zeros((3, 3), np.float32))
    sound = path.read_bytes()
    end = sound[-22:]
    start = int.from_bytes(end[16:20], "little")
    listed = sound[start:-22] * 100_000
    path.write_bytes(sound[:start] + listed + end[:12] + len(listed).to_bytes(4, "little") + end[16:])
    refused(lambda: load_arrays(path, ("vertices",)), "an archive of more than arrays")
    large_end = b"PK\6\7" + bytes(16)
    path.write_bytes(sound[:-22] + large_end + end)
    refused(lambda: load_arrays(path, ("vertices",)), "an archive of more than arrays")


@pytest.mark.parametrize("packing", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_an_archive_that_is_packed_in_ways_that_ask_for_memory(tmp_path: Path, packing: int) -> None:
    path = tmp_path / "template.npz"
    with zipfile.ZipFile(path, "w", packing) as packed:
        packed.writestr("vertices.npy", header((4,)) + bytes(16))
    refused(lambda: load_arrays(path, ("vertices",)), "packed otherwise")


def test_a_million_names_of_parts(tmp_path: Path) -> None:
    path = tmp_path / "template.npz"
    corners, places = np.zeros((1, 3), np.int32), np.eye(3, dtype=np.float32)
    mesh = {"triangles": corners, "uv": places[:, :2], "uv_triangles": corners, "vertices": places}
    np.savez_compressed(path, part_names=np.zeros(10**6, "S1"), **mesh)
    refused(lambda: read_template(path), "part_names")


def test_a_pickle_is_not_unpickled(tmp_path: Path) -> None:
    np.savez(tmp_path / "template.npz", vertices=np.array([{"a": 1}], object), allow_pickle=True)
    refused(lambda: load_arrays(tmp_path / "template.npz", ("vertices",)), "does not hold the numbers|cannot be read")


def test_arrays_that_are_sound_are_read(tmp_path: Path) -> None:
    values = np.asfortranarray(np.arange(12, dtype=np.float32).reshape(3, 4))
    np.savez(tmp_path / "template.npz", vertices=values)
    np.testing.assert_array_equal(load_arrays(tmp_path / "template.npz", ("vertices", "uv"))["vertices"], values)
