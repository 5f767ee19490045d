"""Captures: written and read back, and every fault named with its file before anything starts."""

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from gemheads.models.captures.headmotion import estimated, posed, unposed
from gemheads.models.captures.layout import CaptureError, Template
from gemheads.models.captures.pictures import picture_size, png_bytes
from gemheads.models.captures.reader import KEPT_MOMENTS, open_capture
from gemheads.models.captures.writer import CaptureWriter
from gemheads.render.camera import orbit

RNG = np.random.default_rng(0)
SIZE = 20, 14
TURN, MOVE = np.array([0.05, -0.12, 0.03], np.float32), np.array([0.004, -0.002, 0.003], np.float32)


def sheet() -> Template:
    """A bent sheet of 6 x 6 vertices, as large as a face."""
    y, x = np.mgrid[0:1:6j, 0:1:6j]
    flat = np.stack([x, y], -1).reshape(-1, 2)
    vertices = np.concatenate([flat * 0.2 - 0.1, 0.08 - 0.8 * (flat[:, :1] - 0.5) ** 2 * 0.2], 1)
    a = np.arange(36).reshape(6, 6)
    quads = np.stack([a[:-1, :-1], a[:-1, 1:], a[1:, 1:], a[1:, :-1]], -1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)
    return Template(
        vertices=vertices.astype(np.float32),
        triangles=triangles,
        uv=flat.astype(np.float32),
        uv_triangles=triangles,
        neck_weights=np.clip(flat[:, 1] * 2, 0, 1).astype(np.float32),
        neck_pivot=np.array([0, -0.08, 0], np.float32),
        parts=(np.arange(len(triangles)) % 2).astype(np.uint8),
        part_names=("skin", "teeth"),
    )


def picture(timestep: int, camera: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng([timestep, camera])
    return rng.integers(0, 256, (14, 20, 3), np.uint8), np.full((14, 20), 255, np.uint8)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two cameras, three moments to learn from, one held out."""
    writer, template = CaptureWriter(tmp_path / "capture"), sheet()
    writer.begin(template)
    shots: dict[str, list[Any]] = {"train": [], "val": [], "test": []}
    for timestep in range(4):
        bare = template.vertices + np.float32(1e-3) * timestep
        moved = posed(bare, template.neck_weights, template.neck_pivot, TURN, MOVE)
        writer.write_mesh(timestep, moved, TURN, MOVE, np.full(52, 0.1 * timestep), moved + 1)
        for index in range(2):
            shot = writer.shot(timestep, index, orbit((0, 0, 0), 1.0, 30.0 * index, 5, 25, *SIZE))
            writer.write_picture(shot, *picture(timestep, index))
            shots["test" if timestep == 3 else ("train", "val")[index]].append(shot)
    writer.finish(shots, {"subject": "sheet", "background": [1, 1, 1]})
    return tmp_path / "capture"


def test_what_is_written_is_read(folder: Path) -> None:
    capture = open_capture(folder)
    assert (capture.subject, len(capture.train), len(capture.val), len(capture.test)) == ("sheet", 3, 3, 2)
    assert (capture.timesteps("train"), capture.timesteps("test")) == ((0, 1, 2), (3,))
    for name, value in vars(sheet()).items():
        np.testing.assert_array_equal(getattr(capture.template, name), value)
    shot = capture.test[1]
    assert (shot.timestep, shot.camera_index) == (3, 1)
    wanted = orbit((0, 0, 0), 1.0, 30.0, 5, 25, *SIZE)
    np.testing.assert_allclose(shot.camera.world_to_camera, wanted.world_to_camera, atol=1e-12)
    assert (shot.camera.fx, shot.camera.width) == (wanted.fx, 20)
    np.testing.assert_array_equal(capture.read(shot)[..., :3], picture(3, 1)[0])
    moment = capture.tracked(2)
    np.testing.assert_allclose(moment.vertices, sheet().vertices + np.float32(2e-3), atol=1e-6)
    np.testing.assert_array_equal(moment.rotation, TURN)
    assert moment.arkit is not None
    assert moment.arkit[5] == np.float32(0.2)
    truth = capture.truth(2)
    assert truth is not None
    np.testing.assert_allclose(truth - 1, _vertices(folder, 2), atol=1e-6)


def _vertices(folder: Path, timestep: int) -> np.ndarray:
    return np.load(folder / "meshes" / f"{timestep:05d}.npz")["vertices"]


def test_memory_does_not_grow_with_the_moments(folder: Path) -> None:
    template = sheet()
    tree = json.loads((folder / "transforms_train.json").read_text())
    for timestep in range(4, 4 + 2 * KEPT_MOMENTS):
        (folder / "meshes" / f"{timestep:05d}.npz").write_bytes((folder / "meshes" / "00000.npz").read_bytes())
        tree["frames"].append(
            tree["frames"][0] | {"timestep_index": timestep, "mesh_path": f"meshes/{timestep:05d}.npz"}
        )
    (folder / "transforms_train.json").write_text(json.dumps(tree))
    capture = open_capture(folder)
    for timestep in capture.timesteps("train"):
        assert capture.tracked(timestep).vertices.shape == template.vertices.shape
    assert len(capture._moments) == KEPT_MOMENTS
    assert len({id(shot.camera) for shot in capture.train}) == 1


def test_paths_may_be_written_as_windows_does(folder: Path) -> None:
    path = folder / "transforms_train.json"
    path.write_text(path.read_text().replace("images/", "images\\\\"))
    assert open_capture(folder).train[0].picture.is_file()


def test_soft_edges_lose_the_background(folder: Path) -> None:
    capture = open_capture(folder)
    shot = capture.train[0]
    alpha = np.tile(np.linspace(0, 255, 20).round().astype(np.uint8), (14, 1))
    own = np.array([40, 120, 200])
    share = alpha[..., None] / 255
    over_white = np.round(own * share + 255 * (1 - share)).astype(np.uint8)
    CaptureWriter(folder).write_picture(shot, over_white, alpha)
    rgba = capture.read(shot).astype(float)
    again = rgba[..., :3] * share + 255 * (1 - share)
    np.testing.assert_allclose(again, over_white, atol=1)
    assert np.abs(rgba[:, 8:, :3] - own).max() <= 3


def test_a_mask_is_alpha_or_a_shade_but_no_colour(folder: Path) -> None:
    capture = open_capture(folder)
    shot = capture.train[0]
    assert shot.mask is not None
    shade = np.tile(np.arange(0, 200, 10, dtype=np.uint8), (14, 1))
    opaque, half = np.full((14, 20), 255, np.uint8), np.full((14, 20), 128, np.uint8)
    for channels, wanted in (([shade] * 3 + [opaque], shade), ([opaque] * 3 + [shade], shade), ([shade] * 3, shade)):
        shot.mask.write_bytes(png_bytes(np.dstack(channels)))
        np.testing.assert_array_equal(capture.read(shot)[..., 3], wanted)
    for channels in ([shade, half, half, opaque], [opaque, shade, opaque]):
        shot.mask.write_bytes(png_bytes(np.dstack(channels)))
        with pytest.raises(CaptureError, match=r"00000_00.png: has colours, which no mask has"):
            capture.read(shot)


def test_every_split_has_the_background_that_it_states(folder: Path) -> None:
    path = folder / "transforms_test.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"background": [0, 0, 0]}))
    capture = open_capture(folder)
    assert [capture.ground(shots[0]) for shots in (capture.train, capture.val, capture.test)] == [
        (1, 1, 1),
        (1, 1, 1),
        (0, 0, 0),
    ]
    over_black, alpha = np.full((14, 20, 3), 100, np.uint8), np.full((14, 20), 128, np.uint8)
    CaptureWriter(folder).write_picture(capture.test[0], over_black, alpha)
    np.testing.assert_array_equal(capture.read(capture.test[0])[..., :3], 199)
    np.testing.assert_array_equal(capture.over_background(capture.test[0]), 100)
    path.write_text(json.dumps(json.loads(path.read_text()) | {"background": [0, 0]}))
    with pytest.raises(CaptureError, match=r"transforms_test.json: has background \[0, 0\]"):
        open_capture(folder)


def test_without_a_stated_pose_it_is_estimated(folder: Path) -> None:
    template = sheet()
    for path in (folder / "meshes").iterdir():
        np.savez(path, vertices=np.load(path)["vertices"])
    moment = open_capture(folder).tracked(0)
    np.testing.assert_allclose(moment.rotation, TURN, atol=4e-3)
    np.testing.assert_allclose(moment.vertices, template.vertices, atol=1e-3)
    assert moment.arkit is None


def test_an_estimate_heeds_most_of_the_head() -> None:
    template = RNG.normal(0, 0.05, (400, 3))
    weights, pivot = np.ones(400), np.array([0, -0.1, 0])
    moved = posed(template, weights, pivot, TURN, MOVE)
    moved[:90] += [0, -0.03, 0.01]  # the jaw opens
    rotation, translation = estimated(moved, template, weights, pivot)
    np.testing.assert_allclose(rotation, TURN, atol=1e-4)
    np.testing.assert_allclose(translation, MOVE, atol=1e-4)


@pytest.mark.parametrize("axis", range(3))
def test_half_a_turn_is_no_rest(axis: int) -> None:
    template = RNG.normal(0, 0.05, (40, 3))
    turn = np.pi * np.eye(3)[axis]
    moved = posed(template, np.ones(40), np.zeros(3), turn, MOVE)
    rotation, translation = estimated(moved, template, np.ones(40), np.zeros(3))
    assert np.linalg.norm(rotation) == pytest.approx(np.pi, abs=1e-5)
    np.testing.assert_allclose(unposed(moved, np.ones(40), np.zeros(3), rotation, translation), template, atol=1e-6)


def test_a_pose_is_taken_out_exactly() -> None:
    template, weights = RNG.normal(0, 0.1, (50, 3)), RNG.random(50)
    pivot = np.array([0.01, -0.08, 0.0])
    moved = posed(template, weights, pivot, 5 * TURN, MOVE)
    np.testing.assert_allclose(unposed(moved, weights, pivot, 5 * TURN, MOVE), template, atol=1e-12)
    assert np.abs(moved - template).max() > 0.01


def _frame(change: dict[str, Any], index: int = 1) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        path = folder / "transforms_train.json"
        tree = json.loads(path.read_text())
        for key, value in change.items():
            tree["frames"][index].pop(key) if value is None else tree["frames"][index].update({key: value})
        path.write_text(json.dumps(tree))

    return spoil


def _top(**change: Any) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        path = folder / "transforms_train.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | change))

    return spoil


def _arrays(name: str, **change: Any) -> Callable[[Path], None]:
    def spoil(folder: Path) -> None:
        arrays = dict(np.load(folder / name))
        arrays.update(change)
        np.savez(folder / name, **{key: value for key, value in arrays.items() if value is not None})

    return spoil


def _text(name: str, text: str) -> Callable[[Path], None]:
    return lambda folder: (folder / name).write_text(text) and None


SCALED = (np.diag([2.0, 2, 2, 1])).tolist()
MIRROR = (np.diag([-1.0, 1, 1, 1])).tolist()
NAN = np.full((36, 3), 0, np.float32) + np.where(np.arange(36) == 7, np.nan, 0)[:, None].astype(np.float32)
PNG_END = b"\x00\x00\x00\x00IEND\xaeB`\x82"
HUGE = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sIIBB", 13, b"IHDR", 9000, 9000, 8, 2) + PNG_END


def _torn(suffix: str) -> Callable[[Path], None]:
    """Its last picture ends early, as one that was copied from a full disk."""

    def spoil(folder: Path) -> None:
        path = folder / "images" / "00003_01.png"
        _, data = cv2.imencode(suffix, np.zeros((14, 20, 3), np.uint8))
        path.write_bytes(data.tobytes()[:-2])

    return spoil


def _deep(folder: Path) -> None:
    cv2.imwrite(str(folder / "images" / "00003_01.png"), np.zeros((14, 20, 3), np.uint16))


def _known(split: str, other: str, *taken: int, **change: Any) -> Callable[[Path], None]:
    """Frames of one split stand in another one, too, perhaps as of another camera."""

    def spoil(folder: Path) -> None:
        here, there = (json.loads((folder / f"transforms_{name}.json").read_text()) for name in (split, other))
        there["frames"] += [here["frames"][index] | change for index in taken]
        (folder / f"transforms_{other}.json").write_text(json.dumps(there))

    return spoil


FAULTS: dict[str, tuple[Callable[[Path], None], str]] = {
    "no list of pictures": (lambda f: (f / "transforms_train.json").unlink(), "transforms_train.json: is missing"),
    "missing picture": (lambda f: (f / "images/00001_00.png").unlink(), "images/00001_00.png: is missing"),
    "missing mask": (lambda f: (f / "fg_masks/00002_00.png").unlink(), "fg_masks/00002_00.png: is missing"),
    "wrong size": (_frame({"w": 22}), "images/00001_00.png: is 20x14, its camera 22x14"),
    "wrong mask": (
        lambda f: (f / "fg_masks/00003_01.png").write_bytes(png_bytes(np.zeros((3, 4), np.uint8))) and None,
        "fg_masks/00003_01.png: is 4x3",
    ),
    "more pixels than are read": (
        lambda f: (f / "images/00001_00.png").write_bytes(HUGE) and None,
        "images/00001_00.png: is 9000x9000, more than",
    ),
    "torn PNG": (_torn(".png"), "images/00003_01.png: breaks off before its end"),
    "torn JPEG": (_torn(".jpg"), "images/00003_01.png: breaks off before its end"),
    "16 bits": (_deep, "images/00003_01.png: has 16 bits a channel"),
    "judged by what it taught": (
        _known("train", "val", 2),
        "transforms_val.json: 00002_00.png is in transforms_train.json too, and would judge what it taught",
    ),
    "judged twice": (
        _known("test", "val", 1),
        "transforms_test.json: 00003_01.png is in transforms_val.json too, and would count twice",
    ),
    "an expression that was taught": (
        _known("train", "test", 0, file_path="images/00003_01.png", camera_index=5),
        "transforms_test.json: timestep 0 is in transforms_train.json too, so its expression is not held out",
    ),
    "bent lens": (_frame({"k1": -0.4, "p2": 0.01, "camera_model": "OPENCV"}), r"lens bends lines \(k1, p2\)"),
    "lens of no number": (_frame({"k1": "0.0"}), r"frame 1 \(00001_00.png\): k1 is '0.0', which is no number"),
    "fisheye": (_top(camera_model="OPENCV_FISHEYE"), r"lens bends lines \(OPENCV_FISHEYE\)"),
    "no picture": (_text("images/00000_00.png", "hello"), "images/00000_00.png: is neither PNG nor JPEG"),
    "no intrinsics": (_frame({"fl_x": None, "cy": None}), r"frame 1 \(00001_00.png\) has a camera without fl_x, cy"),
    "no focal length": (_frame({"fl_y": 0}), "frame 1 .*focal lengths must be"),
    "camera of no number": (_frame({"fl_x": float("nan")}), "camera without fl_x"),
    "scaled camera": (_frame({"transform_matrix": SCALED}), "no rotation and translation"),
    "mirrored camera": (_frame({"transform_matrix": MIRROR}), "no rotation and translation"),
    "flat camera": (_frame({"transform_matrix": [[1, 0], [0, 1]]}), "not 4x4"),
    "way out": (_frame({"file_path": "../other/images/00001_00.png"}), "leaves the folder"),
    "way out of the mesh": (_frame({"mesh_path": "/etc/passwd"}), "leaves the folder"),
    "no timestep": (_frame({"timestep_index": "one"}), "timestep_index is 'one'"),
    "two meshes": (_frame({"timestep_index": 0}), "timestep 0 has two meshes"),
    "same number in test": (
        _frame({"timestep_index": 3, "mesh_path": "meshes/00001.npz"}),
        "transforms_test.json: timestep 3 is another moment",
    ),
    "other units": (_top(units="cm"), "is in 'cm'"),
    "odd background": (_top(background=[1, 2, "x"]), "background"),
    "endless background": (_top(background=[1, 2, 10**400]), "background"),
    "endless viewing": (_top(viewing={"target": [0, 0, 10**400], "head_height": 1}), "viewing that is none"),
    "odd viewing": (_top(viewing={"target": [0, 0]}), "viewing that is none"),
    "no frames": (_top(frames=[]), "lists no pictures"),
    "frames of another kind": (_top(frames={}), "no list 'frames'"),
    "no JSON": (_text("transforms_train.json", "{"), "is no JSON"),
    "all lists": (_text("transforms_train.json", '{"frames": [], "x": [' + "[]," * 2**20 + "0]}"), "is all lists"),
    "deep JSON": (_text("transforms_train.json", ("[" + 9 * " ") * 200_000), "nested too deeply"),
    "other topology": (
        _arrays("meshes/00002.npz", vertices=np.zeros((35, 3), np.float32)),
        r"meshes/00002.npz: has vertices of shape \(35, 3\), the template 36 x 3",
    ),
    "NaN": (_arrays("meshes/00001.npz", vertices=NAN), r"meshes/00001.npz: vertices\[7\] is not finite"),
    "half a pose": (_arrays("meshes/00001.npz", rotation=None), "only one of rotation and translation"),
    "objects": (_arrays("meshes/00001.npz", arkit=np.array([{}], object)), "plain arrays"),
    "cut off": (
        lambda f: (f / "meshes/00003.npz").write_bytes((f / "meshes/00003.npz").read_bytes()[:200]) and None,
        "meshes/00003.npz: cannot be read",
    ),
    "other axes": (
        _arrays("meshes/00001.npz", vertices=sheet().vertices * np.array([-1, 1, -1]), rotation=None, translation=None),
        "meshes/00001.npz: lies 0.[0-9]+ m off the template",
    ),
    "other origin": (
        _arrays("meshes/00002.npz", vertices=sheet().vertices + np.array([0, 1.2, 0]), rotation=None, translation=None),
        "meshes/00002.npz: lies .* axes, about its origin",
    ),
    "millimetres": (_arrays("meshes/00003.npz", vertices=1000 * sheet().vertices), "meshes/00003.npz: lies .* metres"),
    "missing mesh": (lambda f: (f / "meshes/00000.npz").unlink(), "meshes/00000.npz: is missing"),
    "no uv": (_arrays("template.npz", uv=None), "template.npz: has no uv"),
    "triangle of nothing": (
        _arrays("template.npz", triangles=np.full((50, 3), 36)),
        r"triangles reaches 36..36, but there are 36",
    ),
    "centimetres": (_arrays("template.npz", vertices=100 * sheet().vertices), "is 20 high"),
    "uv outside": (_arrays("template.npz", uv=sheet().uv * 2), "has uv in 0.00..2.00"),
    "parts of too few": (_arrays("template.npz", parts=np.zeros(3, np.uint8)), "3 parts for 50 triangles"),
    "odd weights": (_arrays("template.npz", neck_weights=np.full(36, 2.0)), "neck_weights in 2.0..2.0"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_each_fault_is_named_with_its_file(folder: Path, fault: str) -> None:
    spoil, said = FAULTS[fault]
    open_capture(folder)
    spoil(folder)
    with pytest.raises(CaptureError, match=said) as raised:
        open_capture(folder)
    assert raised.value.cure
    assert str(raised.value.where).startswith(str(folder))


def test_a_file_of_no_capture_is_said(tmp_path: Path) -> None:
    with pytest.raises(CaptureError, match="is no folder"):
        open_capture(tmp_path / "nothing")


def test_a_lens_without_distortion_may_say_so(folder: Path) -> None:
    _top(k1=None, k2=0, p1=0.0, camera_model="OPENCV")(folder)
    assert len(open_capture(folder).train) == 3


def test_intrinsics_may_stand_once(folder: Path) -> None:
    path = folder / "transforms_train.json"
    tree = json.loads(path.read_text())
    shared = {key: tree["frames"][0][key] for key in ("fl_x", "fl_y", "cx", "cy", "w", "h")}
    for frame in tree["frames"]:
        for key in shared:
            del frame[key]
    path.write_text(json.dumps(tree | shared))
    assert open_capture(folder).train[0].camera.width == 20


def test_sizes_are_read_from_headers(tmp_path: Path) -> None:
    image = np.zeros((31, 57, 3), np.uint8)
    for suffix, end in ((".png", PNG_END), (".jpg", b"\xff\xd9")):
        path = tmp_path / f"a{suffix}"
        data = cv2.imencode(suffix, image)[1].tobytes()
        path.write_bytes(data[:-40] + end + b"notes of a camera")  # what is between header and end does not matter
        assert picture_size(path) == (57, 31)
