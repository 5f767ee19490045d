"""Other people's avatars that want to do harm, or are broken: one error each, soon, with little memory."""

import gzip
import json
import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.models.importers.foreign import ForeignFormatError
from gemheads.models.importers.lam import load_lam
from gemheads.models.importers.meshes import open_meshes
from gemheads.models.importers.splatply import read_splats
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

Edit = Callable[[Any], Any]


def at(*path: Any, value: Any) -> Edit:
    """An edit that puts ``value`` into the tree."""

    def edit(tree: Any) -> None:
        for key in path[:-1]:
            tree = tree[key]
        tree[path[-1]] = value

    return edit


def refused(read: Callable[[], object], said: str) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(ForeignFormatError, match=said) as caught:
            read()
        assert tracemalloc.get_traced_memory()[1] < 2e7
    finally:
        tracemalloc.stop()
    assert "; " in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


HUGE = 2**31
MESH = ("meshes", 0, "primitives", 0)
SPARSE = ("accessors", 3, "sparse")


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (at("accessors", 0, "count", value=HUGE), "vertices count"),
        (at("accessors", 0, "count", value=-1), "vertices count"),
        (at("accessors", 0, "count", value=True), "do not fit|count|triangles|splats"),
        (at("accessors", 0, "count", value=1e3), "vertices count"),
        (at("accessors", 0, "count", value=145), "do not fit"),
        (at("accessors", 0, "componentType", value=5130), "component type 5130"),
        (at("accessors", 0, "componentType", value=[5126]), "component type"),
        (at("accessors", 0, "componentType", value=5125), "component type 5125"),
        (at("accessors", 0, "type", value="MAT4"), "'MAT4' instead of VEC3"),
        (at("accessors", 0, "byteOffset", value=-4), "outside of the buffer"),
        (at("accessors", 0, "byteOffset", value=4), "do not fit"),
        (at("accessors", 0, "bufferView", value=99), "no entry 99"),
        (at("accessors", 0, "bufferView", value=-1), "no entry -1"),
        (at("accessors", 0, "bufferView", value="0"), "no entry '0'"),
        (lambda tree: tree["accessors"][0].pop("bufferView"), "lie nowhere"),
        (at("accessors", 2, "count", value=143), "count 143 instead of 144"),
        (at("accessors", 3, "count", value=HUGE), "instead of 144"),
        (at("accessors", 3, value=None), "not an object"),
        (at(*SPARSE, "count", value=HUGE), "sparse part"),
        (at(*SPARSE, "count", value=4), "do not fit"),
        (at(*SPARSE, "indices", "componentType", value=5126), "component type 5126"),
        (at(*SPARSE, "indices", value=None), "sparse part"),
        (at("bufferViews", 2, "byteLength", value=HUGE), "outside of the buffer"),
        (at("bufferViews", 2, "byteOffset", value=HUGE), "outside of the buffer"),
        (at("bufferViews", 2, "byteStride", value=1), "stride of 1"),
        (at("bufferViews", 2, "byteStride", value=HUGE), "stride"),
        (at("bufferViews", 2, "buffer", value=1), "another buffer"),
        (at("buffers", 0, "uri", value="file:///etc/passwd"), "in other files"),
        (at("buffers", value=[{}, {}]), "several buffers"),
        (at("extensionsRequired", value=["KHR_draco_mesh_compression"]), "KHR_draco"),
        (at("meshes", value=[]), "no entry 0"),
        (at("meshes", value={}), "first mesh"),
        (at(*MESH, "mode", value=1), "not of triangles"),
        (at(*MESH, "attributes", value=None), "not of triangles"),
        (at(*MESH, "attributes", value={}), "no entry None"),
        (at(*MESH, "targets", value=[{}]), "have no names"),
        (at(*MESH, "targets", value=[{}, {}]), "no entry None"),
        (at(*MESH, "targets", value=[3, 4]), "no entry None"),
        (at("meshes", 0, "extras", "targetNames", value=["a", {}]), "ARKit name"),
        (at("meshes", 0, "extras", "targetNames", value=["jawOpen", "jawOpen"]), "ARKit name"),
        (at("meshes", 0, "extras", value=3), "have no names"),
    ],
)
def test_trees(lam: Any, tmp_path: Path, edit: Edit, said: str) -> None:
    edit(lam.tree)
    folder = lam.write(tmp_path / "lam")
    refused(lambda: load_lam(folder), said)


def test_triangles_without_end(lam: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each takes hundreds of bytes of memory, and a few in the file."""
    monkeypatch.setattr("gemheads.models.importers.lam.MAX_TRIANGLES", 5)
    with pytest.raises(ForeignFormatError, match="corners of triangles, 15 are read"):
        load_lam(lam.write(tmp_path / "lam"))


def test_indices_beyond_the_vertices(lam: Any, tmp_path: Path) -> None:
    for accessor, what in ((1, "triangles point beyond"), (3, "points beyond its 144")):
        entry = lam.tree["accessors"][accessor]
        view = entry.get("bufferView", entry.get("sparse", {}).get("indices", {}).get("bufferView"))
        start = lam.tree["bufferViews"][view]["byteOffset"]
        before = bytes(lam.buffer[start : start + 2])
        lam.buffer[start : start + 2] = b"\xff\xff"
        folder = lam.write(tmp_path / "lam")
        refused(lambda folder=folder: load_lam(folder), what)
        lam.buffer[start : start + 2] = before


@pytest.mark.parametrize(("value", "said"), [(np.nan, "not all finite"), (3e38, "farther than 1000")])
@pytest.mark.parametrize("accessor", [0, 2])
def test_vertices_and_shapes_beyond_all_bounds(
    lam: Any, tmp_path: Path, accessor: int, value: float, said: str
) -> None:
    start = lam.tree["bufferViews"][lam.tree["accessors"][accessor]["bufferView"]]["byteOffset"]
    lam.buffer[start : start + 4] = np.float32(value).tobytes()
    folder = lam.write(tmp_path / "lam")
    refused(lambda: load_lam(folder), said)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda glb: b"", "no binary glTF"),
        (lambda glb: b"glTF" + b"\xff" * 40, "no binary glTF"),
        (lambda glb: glb[:-1], "told and"),
        (lambda glb: glb[:4] + b"\1" + glb[5:], "version 1"),
        (lambda glb: glb[:12] + b"\xff\xff\xff\xff" + glb[16:], "description claims"),
        (lambda glb: glb.replace(b"BIN\0", b"EVIL"), "buffer is missing"),
        (lambda glb: gzip.compress(glb + bytes(2**24)), "no binary glTF"),  # 16 MiB in 16 KiB, never unpacked
        (lambda glb: glb.replace(b"BIN\0", b"BIN\0" + gzip.compress(bytes(2**24))), "told and"),
    ],
)
def test_bytes(lam: Any, tmp_path: Path, edit: Callable[[bytes], bytes], said: str) -> None:
    folder = lam.write(tmp_path / "lam", edit(lam.glb()))
    refused(lambda: load_lam(folder), said)


@pytest.mark.parametrize("text", [b"[" * 500_000, b"nonsense", b"[]", b"\xff\xfe{}", b'{"a":' + b"9" * 5000 + b"}"])
def test_json(lam: Any, tmp_path: Path, text: bytes) -> None:
    folder = lam.write(tmp_path / "lam", lam.glb(text))
    refused(lambda: load_lam(folder), "no JSON|not a JSON object")


def test_a_folder_a_pipe_and_nothing(lam: Any, tmp_path: Path) -> None:
    folder = lam.write(tmp_path / "lam")
    (folder / "offset.ply").unlink()
    refused(lambda: load_lam(folder), "cannot be read")
    (folder / "skin.glb").unlink()
    (folder / "skin.glb").mkdir()
    refused(lambda: load_lam(folder), "no ordinary file")


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda ply: b"", "no PLY"),
        (lambda ply: ply[:100], "no PLY"),
        (
            lambda ply: ply.replace(b"binary_little_endian", b"ascii"),
            "written as 'format ascii 1.0', which is not read",
        ),
        (lambda ply: ply.replace(b"binary_little_endian", b"binary_big_endian"), "big_endian"),
        (lambda ply: ply.replace(b"vertex 144", b"vertex 999999999"), "claims 999999999 splats"),
        (lambda ply: ply.replace(b"vertex 144", b"vertex " + b"9" * 3000), "claims 9999"),
        (lambda ply: ply.replace(b"vertex 144", b"vertex -144"), "claims -144"),
        (lambda ply: ply.replace(b"vertex 144", b"vertex 0"), "claims 0"),
        (lambda ply: ply.replace(b"vertex 144", b"vertex 145"), "need 9860 bytes, 9792 are there"),
        (lambda ply: ply.replace(b"vertex 144", b"face 144"), "first element is not vertex"),
        (lambda ply: ply.replace(b"float rot_3", b"uchar rot_3"), "uchar rot_3"),
        (lambda ply: ply.replace(b"property float rot_3", b"property list uchar int rot_3"), "list uchar"),
        (lambda ply: ply.replace(b"float rot_3", b"float rot_9"), "lack rot_3"),
        (lambda ply: ply.replace(b"float rot_3", b"float rot_2"), "stands twice"),
        (lambda ply: ply[:-4] + np.float32(np.inf).tobytes(), "not finite"),
        (lambda ply: ply[: -4 * 17] + np.float32(1e30).tobytes() + ply[-4 * 16 :], "farther than 1000"),
    ],
)
def test_ply(lam: Any, tmp_path: Path, edit: Callable[[bytes], bytes], said: str) -> None:
    path = lam.write(tmp_path / "lam") / "offset.ply"
    path.write_bytes(edit(path.read_bytes()))
    refused(lambda: read_splats(path), said)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(edits=st.lists(st.tuples(st.integers(0, 2**13), st.binary(min_size=1, max_size=5)), min_size=1, max_size=4))
def test_any_bytes_open_or_are_refused(
    lam: Any, tmp_path_factory: pytest.TempPathFactory, edits: list[tuple[int, bytes]]
) -> None:
    content = bytearray(lam.glb())
    end = 20 + len(json.dumps(lam.tree)) + 200
    for place, piece in edits:
        start = place % min(end, len(content))
        content[start : start + len(piece)] = piece
    folder = lam.write(tmp_path_factory.mktemp("fuzzed"), bytes(content))
    with suppress(ForeignFormatError):
        load_lam(folder)


@pytest.mark.parametrize("line", ["v 0 0 0\n", "f 1 1 1\n", "\n"], ids=["vertices", "triangles", "nothing"])
def test_a_mesh_of_lines_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    for name in ("VERTICES", "TRIANGLES", "OBJ_LINES"):
        monkeypatch.setattr(f"gemheads.models.importers.meshes.MAX_{name}", 10_000)
    (tmp_path / "0.obj").write_text("v 0 0 0\n" * 3 + line * 1_000_000)
    refused(lambda: open_meshes(tmp_path), "more than 10000 vertices, 10000 triangles or 10000 lines")


@pytest.mark.parametrize("kind", ["v", "f"])
def test_a_mesh_of_one_endless_line(tmp_path: Path, kind: str) -> None:
    (tmp_path / "0.obj").write_text(f"v 0 0 0\n{kind} " + "1 " * 2_000_000)
    refused(lambda: open_meshes(tmp_path), "no faces|neither vertex nor triangle in line 2")
