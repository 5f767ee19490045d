"""transforms_SPLIT.json: which camera took which picture of which moment (the form of NeRF, nerfstudio, NeRSemble)."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from ...render.camera import Camera
from .layout import MESHES, UNITS, CaptureError, Shot, mesh_name

MAX_BYTES = 64 * 2**20
"""Some 75,000 pictures; more is no list of one capture."""
BYTES_A_BRACKET = 8
"""A camera's matrix alone has more for each list in it; what has fewer fills the memory with empty lists."""
_GL_FROM_CV = np.diag([1.0, -1.0, -1.0, 1.0])
"""OpenGL cameras (x right, y up, looking along -z) and ours (x right, y down, along +z) differ by two signs."""
_RIGID_TOLERANCE = 1e-3
_MAX_PATH = 400
_INTRINSICS = ("fl_x", "fl_y", "cx", "cy", "w", "h")
_DISTORTION = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2")
_STRAIGHT = ("PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "FULL_OPENCV")
"""Camera models whose lenses are straight where no number of _DISTORTION says otherwise."""
_FRAME_CURE = "correct that frame, or take it out"


@dataclass(frozen=True)
class Transforms:
    """One split, understood."""

    about: Mapping[str, Any]
    """What the file says beside its frames."""
    shots: tuple[Shot, ...]
    meshes: Mapping[int, Path]
    """Timestep -> the file of its tracked mesh."""


def read_transforms(path: Path) -> Transforms:
    """The pictures that a transforms file lists; of the pictures themselves nothing is looked at.

    Raises CaptureError where the file is missing, too large, no JSON of this form, where a camera is none, or where
    a path leaves the folder.
    """
    tree = _load(path)
    frames = tree.get("frames")
    if not isinstance(frames, list):
        raise CaptureError(path, "has no list 'frames'", "export it in the form of docs/captures.md")
    if (units := tree.get("units", UNITS)) != UNITS:
        raise CaptureError(path, f"is in {units!r}", "scale cameras and meshes to metres and say 'units': 'm'")
    background = _background(path, tree)
    shots, meshes, cameras = [], {}, {}
    for index, frame in enumerate(frames):
        if not isinstance(frame, dict):
            raise CaptureError(path, f"frame {index} is no object", _FRAME_CURE)
        shot = replace(_shot(path, f"frame {index}", tree, frame, cameras), background=background)
        mesh = _inside(path, f"frame {index}", frame.get("mesh_path", f"{MESHES}/{mesh_name(shot.timestep)}"))
        if meshes.setdefault(shot.timestep, mesh) != mesh:
            both = f"{meshes[shot.timestep].name} and {mesh.name}"
            raise CaptureError(path, f"timestep {shot.timestep} has two meshes, {both}", "number timesteps uniquely")
        shots.append(shot)
    return Transforms({name: value for name, value in tree.items() if name != "frames"}, tuple(shots), meshes)


def frame_of(shot: Shot, folder: Path) -> dict[str, Any]:
    """The JSON object of a shot whose files lie in ``folder``."""
    camera = shot.camera
    intrinsics = (camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height)
    to_world = np.linalg.inv(camera.world_to_camera) @ _GL_FROM_CV
    frame: dict[str, Any] = {
        "file_path": shot.picture.relative_to(folder).as_posix(),
        "transform_matrix": to_world.tolist(),
        **dict(zip(_INTRINSICS, intrinsics, strict=True)),
        "timestep_index": shot.timestep,
        "camera_index": shot.camera_index,
        "mesh_path": f"{MESHES}/{mesh_name(shot.timestep)}",
    }
    if shot.mask is not None:
        frame["fg_mask_path"] = shot.mask.relative_to(folder).as_posix()
    return frame


def _load(path: Path) -> dict[str, Any]:
    try:
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise CaptureError(path, f"is {size / 2**20:.0f} MiB", f"at most {MAX_BYTES // 2**20} MiB are read")
        text = path.read_bytes()
        if text.count(b"[") + text.count(b"{") > 1000 + len(text) // BYTES_A_BRACKET:
            raise CaptureError(path, "is all lists", "export it in the form of docs/captures.md")
        tree = json.loads(text)
    except FileNotFoundError:
        raise CaptureError(path, "is missing", "a capture lists its pictures there (docs/captures.md)") from None
    except OSError as error:
        raise CaptureError(path, f"cannot be read ({error.strerror})", "check the path and its permissions") from error
    except RecursionError:
        raise CaptureError(path, "is nested too deeply", "export it in the form of docs/captures.md") from None
    except ValueError as error:
        raise CaptureError(path, f"is no JSON ({error})", "export it again") from error
    if not isinstance(tree, dict):
        raise CaptureError(path, "is no JSON object", "export it in the form of docs/captures.md")
    return tree


def _background(path: Path, tree: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """sRGB in 0..1 of what is behind the person; None where nothing is stated."""
    if "background" not in tree:
        return None
    try:
        red, green, blue = (float(value) for value in tree["background"])
    except (TypeError, ValueError, OverflowError):
        red = green = blue = -1.0
    if not all(0 <= value <= 1 for value in (red, green, blue)):
        raise CaptureError(path, f"has background {tree['background']!r}", "give three numbers in 0..1")
    return red, green, blue


def _shot(
    path: Path, name: str, tree: Mapping[str, Any], frame: Mapping[str, Any], cameras: dict[bytes, Camera]
) -> Shot:
    picture = _inside(path, name, frame.get("file_path"))
    mask = frame.get("fg_mask_path")
    values = [frame.get(key, tree.get(key)) for key in _INTRINSICS]
    lacking = [key for key, value in zip(_INTRINSICS, values, strict=True) if not _is_number(value)]
    if lacking:
        raise CaptureError(path, f"{name} ({picture.name}) has a camera without {', '.join(lacking)}", _FRAME_CURE)
    _check_lens(path, f"{name} ({picture.name})", tree, frame)
    fx, fy, cx, cy, w, h = map(float, values)
    matrix = _matrix(path, f"{name} ({picture.name})", frame.get("transform_matrix"))
    key = np.array([fx, fy, cx, cy, w, h, *matrix.ravel()]).tobytes()
    if key not in cameras:
        if w != int(w) or h != int(h):
            raise CaptureError(path, f"{name} is {w} x {h} pixels", _FRAME_CURE)
        try:
            cameras[key] = Camera(fx, fy, cx, cy, int(w), int(h), np.linalg.inv(matrix @ _GL_FROM_CV))
        except ValueError as error:
            raise CaptureError(path, f"{name} ({picture.name}): {error}", _FRAME_CURE) from error
    return Shot(
        picture=picture,
        mask=None if mask is None else _inside(path, name, mask),
        camera=cameras[key],
        camera_index=_whole(path, name, frame, "camera_index"),
        timestep=_whole(path, name, frame, "timestep_index"),
    )


def _check_lens(path: Path, name: str, tree: Mapping[str, Any], frame: Mapping[str, Any]) -> None:
    """Raises CaptureError for a lens that bends lines: nothing here would straighten them."""
    said = {key: frame.get(key, tree.get(key)) for key in _DISTORTION}
    if odd := [key for key, value in said.items() if value is not None and not _is_number(value)]:
        raise CaptureError(path, f"{name}: {odd[0]} is {said[odd[0]]!r}, which is no number", "give a number, or none")
    bent = [key for key, value in said.items() if value]
    model = frame.get("camera_model", tree.get("camera_model", "PINHOLE"))
    if bent or model not in _STRAIGHT:
        what = f"{name}: its lens bends lines ({', '.join(bent) or model})"
        raise CaptureError(path, what, "undistort the pictures first, such as with colmap image_undistorter")


def _matrix(path: Path, name: str, value: Any) -> np.ndarray:
    """The camera's place in the world [4, 4]: a rotation and a translation, nothing else."""
    try:
        matrix = np.array(value, np.float64)
    except (TypeError, ValueError, OverflowError):
        matrix = np.zeros(0)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise CaptureError(path, f"{name}: transform_matrix is not 4x4 finite numbers", _FRAME_CURE)
    turn = matrix[:3, :3]
    off = np.abs(turn @ turn.T - np.eye(3)).max()
    if off > _RIGID_TOLERANCE or np.linalg.det(turn) < 0 or np.abs(matrix[3] - [0, 0, 0, 1]).max() > 1e-6:
        what = f"{name}: transform_matrix is no rotation and translation (off by {off:.2g})"
        raise CaptureError(path, what, "give camera to world, without scale, OpenGL axes")
    return matrix


def _inside(path: Path, name: str, value: Any) -> Path:
    """A path of the transforms file, which has to stay in its folder."""
    if not isinstance(value, str) or not 0 < len(value) <= _MAX_PATH or "\0" in value:
        raise CaptureError(path, f"{name} has no file_path, or one that is no text", _FRAME_CURE)
    value = value.replace("\\", "/")  # as Windows writes paths
    relative = PurePosixPath(value)
    if not relative.parts:
        raise CaptureError(path, f"{name}: {value!r} names no file", _FRAME_CURE)
    if relative.is_absolute() or ".." in relative.parts or Path(value).is_absolute() or ":" in relative.parts[0]:
        raise CaptureError(path, f"{name}: {value!r} leaves the folder", "copy or link those files into it")
    return path.parent / relative


def _whole(path: Path, name: str, frame: Mapping[str, Any], key: str) -> int:
    value = frame.get(key)
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**31:
        raise CaptureError(path, f"{name}: {key} is {value!r}, not a whole number from 0 on", _FRAME_CURE)
    return value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e9
