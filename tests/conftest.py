"""Small avatars for tests of every room."""

import json
import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

# as the command does, and before any library starts its threads: idle ones spin against those of the others
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import moderngl
import numpy as np
import pytest
from gemheads.models.gem import Gem
from gemheads.models.ply import SH_C0, save_ply
from gemheads.render.gaussians import RawGaussians
from gemheads.render.rotations import normalized
from gems import six_splats


@pytest.fixture(scope="session", autouse=True)
def own_data_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where this run keeps its avatars and the key that it signs with: never the folder of whoever runs the tests."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("data")
        patch.setenv("XDG_DATA_HOME", str(folder))
        patch.setattr("platformdirs.user_data_dir", lambda name, **_: str(folder / name))
        yield folder


@pytest.fixture(autouse=True)
def no_gl_error(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No test may leave an OpenGL error behind in any context that it opened, wherever it was opened and closed."""
    opened: list[moderngl.Context] = []
    found: list[str] = []
    create, release = moderngl.create_context, moderngl.Context.release

    def watched(*arguments: Any, **settings: Any) -> moderngl.Context:
        opened.append(create(*arguments, **settings))
        return opened[-1]

    def looked_at(context: moderngl.Context) -> None:
        if context in opened:
            opened.remove(context)
            with context:
                found.append(context.error)
        release(context)

    monkeypatch.setattr(moderngl, "create_context", watched)
    monkeypatch.setattr(moderngl.Context, "release", looked_at)
    yield
    for context in opened:
        with context:
            found.append(context.error)
    assert set(found) <= {"GL_NO_ERROR"}


@pytest.fixture
def tiny_gem() -> Gem:
    """An avatar that can be looked through number by number."""
    return six_splats()


@dataclass
class LamPieces:
    """A small LAM avatar in pieces: a bent sheet of 12 x 12 vertices whose jawOpen pulls its lower half down and
    whose browInnerUp, stored sparsely, lifts a corner. ``write`` checks nothing."""

    tree: dict[str, Any]
    buffer: bytearray
    splats: RawGaussians
    """Offsets from the vertices; colours as plain RGB."""
    vertices: np.ndarray
    triangles: np.ndarray
    shapes: dict[str, np.ndarray]

    def glb(self, text: bytes | None = None) -> bytes:
        """The mesh's file."""
        text = json.dumps(self.tree).encode() if text is None else text
        text += b" " * (-len(text) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text
        body += struct.pack("<I4s", len(self.buffer), b"BIN\0") + bytes(self.buffer)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body

    def write(self, folder: Path, glb: bytes | None = None) -> Path:
        """The avatar's folder."""
        folder.mkdir(exist_ok=True)
        (folder / "skin.glb").write_bytes(self.glb() if glb is None else glb)
        # LAM writes RGB where others write harmonics
        save_ply(replace(self.splats, colors=0.5 + SH_C0 * self.splats.colors), folder / "offset.ply")
        return folder


@pytest.fixture
def lam() -> LamPieces:
    """A LAM avatar that opens."""
    side = 12
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-0.08, 0.08, side), np.linspace(1.5, 1.8, side)))
    vertices = np.stack([x, y, 0.1 - 4 * x * x], 1).astype(np.float32)
    corner = np.arange(side * side).reshape(side, side)[:-1, :-1].ravel()
    quads = np.stack([corner, corner + 1, corner + side, corner + 1, corner + side + 1, corner + side], 1)
    triangles = quads.reshape(-1, 3).astype(np.uint16)
    jaw = np.zeros_like(vertices)
    jaw[:, 1:] = np.minimum(y - 1.6, 0)[:, None] * np.float32([0.3, 0.2])
    brow = np.zeros_like(vertices)
    brow[-3:] = (0, 0.01, 0)
    buffer = bytearray()
    views: list[dict[str, int]] = []

    def stored(values: np.ndarray) -> int:
        views.append({"buffer": 0, "byteOffset": len(buffer), "byteLength": values.nbytes})
        buffer.extend(values.tobytes() + b"\0" * (-values.nbytes % 4))
        return len(views) - 1

    count = len(vertices)
    dense = {"componentType": 5126, "count": count, "type": "VEC3"}
    sparse = {
        "count": 3,
        "indices": {"bufferView": stored(np.arange(count - 3, count, dtype=np.uint16)), "componentType": 5123},
        "values": {"bufferView": stored(brow[-3:])},
    }
    tree: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "meshes": [
            {
                "extras": {"targetNames": ["jawOpen", "browInnerUp"]},
                "primitives": [
                    {"attributes": {"POSITION": 0}, "indices": 1, "targets": [{"POSITION": 2}, {"POSITION": 3}]}
                ],
            }
        ],
        "accessors": [
            {"bufferView": stored(vertices), **dense},
            {"bufferView": stored(triangles), "componentType": 5123, "count": triangles.size, "type": "SCALAR"},
            {"bufferView": stored(jaw), **dense},
            {"sparse": sparse, **dense},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(buffer)}],
    }
    rng = np.random.default_rng(3)
    splats = RawGaussians(
        rng.normal(0, 0.002, (count, 3)).astype(np.float32),
        normalized(rng.normal(size=(count, 4))).astype(np.float32),
        rng.uniform(-6, -4, (count, 3)).astype(np.float32),
        np.full(count, 3, np.float32),
        rng.uniform(0, 1, (count, 3)).astype(np.float32),
    )
    return LamPieces(tree, buffer, splats, vertices, triangles, {"jawOpen": jaw, "browInnerUp": brow})


@pytest.fixture(scope="session")
def toy_capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A capture of 64 x 64 pixels: 6 training moments and 2 others, 4 cameras and 1 held out."""
    from toycapture import write_capture

    return write_capture(tmp_path_factory.mktemp("captures") / "toy")
