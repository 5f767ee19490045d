"""Small honest files of every kind, which open: what the mutations begin with."""

import hashlib
import json
from datetime import date
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
from gemheads.app.desk.settings import Settings, save_settings
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, save_track
from gemheads.app.performing.weights import WeightsTrack, save_weights
from gemheads.app.person.profiles import save_profile
from gemheads.app.person.restface import Resting
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.neutral import NeutralChoice
from gemheads.models.driver.regressor import FEATURES_INPUT, OUTPUT, ROTATION_INPUT
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing
from gemheads.models.gemfile import save_gem
from gemheads.models.ply import save_ply
from gemheads.render.gaussians import RawGaussians
from onnx import TensorProto, helper, numpy_helper

from .glbs import packed

SPLATS, COMPONENTS, FRAMES = 24, 2, 5
CAMERA_NAME = "a camera"


def gem(folder: Path) -> bytes:
    """An avatar with everything that a file may hold, but a regressor that is none."""
    bases = {}
    for name in MODALITIES:
        width = SPLATS * CHANNELS[name]
        rows = (np.arange((COMPONENTS + 1) * width).reshape(COMPONENTS + 1, width) * 5 % 11 - 5) / 16
        bases[name] = Basis(rows.astype(np.float32), np.full(COMPONENTS, 0.25, np.float32))
    total = COMPONENTS * len(MODALITIES)
    save_gem(
        Gem(
            name="Tiny",
            bases=bases,
            colors=np.full((SPLATS, 3), 0.5, np.float32),
            neck_weights=np.ones(SPLATS, np.float32),
            neck_pivot=np.zeros(3, np.float32),
            uv_index=np.zeros((SPLATS, 2), np.uint16),
            uv_size=16,
            viewing=Viewing((0.0, 0.0, 0.0), 0.25),
            arkit_weights=np.full((52, total), 0.1, np.float32),
            rest=np.zeros(total, np.float32),
            regressor=b"graph",
            about={"author": "nobody", "licence": "CC0-1.0"},
        ),
        folder / "honest.gem",
    )
    return (folder / "honest.gem").read_bytes()


def track(folder: Path) -> bytes:
    """A performance of somebody's coefficients."""
    poses = tuple(Pose(np.zeros(4, np.float32), np.zeros(3, np.float32)) for _ in range(FRAMES))
    pts = np.arange(FRAMES, dtype=np.int64) * 1001
    save_track(Track("Tiny", hashlib.sha256().hexdigest(), Fraction(1, 30000), Fraction(30), pts, poses), folder / "t")
    return (folder / "t").read_bytes()


def weights(folder: Path) -> bytes:
    """A performance in ARKit weights."""
    pts = np.arange(FRAMES, dtype=np.int64)
    moves = np.full((FRAMES, 52), 0.5, np.float32), np.zeros((FRAMES, 3), np.float32)
    save_weights(WeightsTrack("nod", Fraction(1, 30), pts, *moves), folder / "w")
    return (folder / "w").read_bytes()


def profile(folder: Path) -> bytes:
    """A neutral that was kept for CAMERA_NAME."""
    choice = NeutralChoice(0, 0.0, np.zeros(DIMENSION, np.float32), np.zeros(3), "", ())
    resting = Resting(choice, np.zeros(DIMENSION, np.float32), 0.0, "")
    return save_profile(CAMERA_NAME, resting, date(2026, 1, 2), folder).read_bytes()


def splats() -> RawGaussians:
    """A ball of splats half a metre high."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(SPLATS, 3))
    points *= 0.25 / np.linalg.norm(points, axis=1, keepdims=True)
    parts = (points, np.tile([1.0, 0, 0, 0], (SPLATS, 1)), np.full((SPLATS, 3), -5), np.full(SPLATS, 3))
    return RawGaussians(*(np.asarray(part, np.float32) for part in (*parts, np.full((SPLATS, 3), 0.5))))


def ply(folder: Path) -> bytes:
    """Splats as other programs store them."""
    save_ply(splats(), folder / "honest.ply")
    return (folder / "honest.ply").read_bytes()


def glb(folder: Path) -> bytes:
    """The mesh of a LAM avatar, whose splats are put beside it."""
    save_ply(splats(), folder / "offset.ply")
    vertices = (splats().positions + np.float32([0, 1.6, 0])).astype(np.float32)
    triangles = np.arange(SPLATS // 3 * 3, dtype=np.uint16)
    shape = np.full_like(vertices, 0.01)
    arrays = (vertices, triangles, shape, np.arange(3, dtype=np.uint16), shape[:3])
    buffer, views = b"", []
    for array in arrays:
        views.append({"buffer": 0, "byteOffset": len(buffer), "byteLength": array.nbytes})
        buffer += array.tobytes() + bytes(-array.nbytes % 4)
    dense = {"componentType": 5126, "count": SPLATS, "type": "VEC3"}
    sparse = {"count": 3, "indices": {"bufferView": 3, "componentType": 5123}, "values": {"bufferView": 4}}
    mesh = {"attributes": {"POSITION": 0}, "indices": 1, "targets": [{"POSITION": 2}, {"POSITION": 3}]}
    tree = {
        "asset": {"version": "2.0"},
        "meshes": [{"extras": {"targetNames": ["jawOpen", "browInnerUp"]}, "primitives": [mesh]}],
        "accessors": [
            {"bufferView": 0, **dense},
            {"bufferView": 1, "componentType": 5123, "count": len(triangles), "type": "SCALAR"},
            {"bufferView": 2, **dense},
            {"sparse": sparse, **dense},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": len(buffer)}],
    }
    return packed(json.dumps(tree).encode(), buffer)


def camera(folder: Path) -> bytes:
    """Where a picture was taken from."""
    matrix = np.eye(4).tolist()
    tree = {"fx": 500.0, "fy": 500.0, "cx": 32.0, "cy": 32.0, "width": 64, "height": 64, "world_to_camera": matrix}
    return json.dumps(tree).encode()


def settings(folder: Path) -> bytes:
    """What the window remembers."""
    wishes = {"mirror": True, "smoothing": 0.5, "background": "grey", "ui_scale": 1.0}
    said = save_settings(Settings(wishes, "mara", CAMERA_NAME, (800, 600), {"quit": ("Ctrl+Q",)}), folder / "live.toml")
    assert not said
    return (folder / "live.toml").read_bytes()


def onnx(folder: Path) -> bytes:
    """A regressor of COMPONENTS coefficients: 3 tanh(r W + rotation V)."""
    constants = [
        numpy_helper.from_array(np.full((DIMENSION, COMPONENTS), 0.01, np.float32), "W"),
        numpy_helper.from_array(np.ones((3, COMPONENTS), np.float32), "V"),
        numpy_helper.from_array(np.float32(3), "limit"),
    ]
    nodes = [
        helper.make_node("MatMul", [FEATURES_INPUT, "W"], ["a"]),
        helper.make_node("MatMul", [ROTATION_INPUT, "V"], ["b"]),
        helper.make_node("Add", ["a", "b"], ["c"]),
        helper.make_node("Tanh", ["c"], ["d"]),
        helper.make_node("Mul", ["d", "limit"], [OUTPUT]),
    ]
    sizes = ((FEATURES_INPUT, DIMENSION), (ROTATION_INPUT, 3), (OUTPUT, COMPONENTS))
    *inputs, output = (helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, size]) for name, size in sizes)
    graph = helper.make_graph(nodes, "regressor", inputs, [output], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    return model.SerializeToString()


def video(folder: Path) -> bytes:
    """Four pictures of H.264 in an mp4."""
    path = folder / "honest.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=30, options={"preset": "ultrafast"})
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for number in range(4):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(_picture(number), format="rgb24")))
        container.mux(stream.encode())
    return path.read_bytes()


def png(folder: Path) -> bytes:
    """A picture."""
    return cv2.imencode(".png", _picture(3))[1].tobytes()


def jpeg(folder: Path) -> bytes:
    """A picture as phones take them."""
    return cv2.imencode(".jpg", _picture(3))[1].tobytes()


def webp(folder: Path) -> bytes:
    """A picture as browsers save them."""
    return cv2.imencode(".webp", _picture(3))[1].tobytes()


def tiff(folder: Path) -> bytes:
    """A picture as scanners save them."""
    return cv2.imencode(".tiff", _picture(3))[1].tobytes()


def bmp(folder: Path) -> bytes:
    """A picture without compression."""
    return cv2.imencode(".bmp", _picture(3))[1].tobytes()


def osc(folder: Path) -> bytes:
    """A packet of a face-tracking program."""
    from pythonosc.osc_message_builder import OscMessageBuilder

    builder = OscMessageBuilder("/VMC/Ext/Blend/Val")
    builder.add_arg("jawOpen")
    builder.add_arg(0.5)
    return builder.build().dgram


def _picture(number: int) -> np.ndarray:
    image = np.zeros((48, 64, 3), np.uint8)
    image[:24, :32] = 60 * number
    return image
