"""A UV map without overlap for a tracked head: skin, eyes, teeth and tongue side by side, the face given most room."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .head import Head
from .soup import EYES, SKIN, TEETH, TONGUE
from .subjectfile import EYES_PART_U

Box = tuple[float, float, float, float]

ISLANDS: dict[str, tuple[Box, Box]] = {
    # island of MakeHuman's map: where it lies there, and where it goes (left, bottom, right, top)
    "head": ((0.640, 0.146, 0.996, 0.820), (0.004, 0.284, 0.996, 0.996)),
    "torso": ((0.180, 0.780, 0.590, 0.980), (0.004, 0.004, 0.336, 0.276)),
    "mouth": ((0.755, 0.005, 0.930, 0.140), (0.344, 0.004, 0.544, 0.138)),
}
"""What is on none of them, the sockets behind the eyes, is never seen and left out."""
EYE_BOXES: tuple[Box, Box] = (
    (EYES_PART_U + 0.004, 0.146, 0.612, 0.276),
    (0.344, 0.146, EYES_PART_U - 0.004, 0.276),
)
"""The person's left eye, then the right: side by side as they are seen."""
TEETH_BOX: Box = (0.620, 0.146, 0.996, 0.276)
TONGUE_BOX: Box = (0.552, 0.004, 0.682, 0.138)
EYE_REACH_RAD = 1.6
"""An eyeball is laid flat around its pupil up to this angle; what is further back is left out."""
FACE_ACROSS = (0.5, 0.14, 3.2)
FACE_ALONG = (0.44, 0.20, 1.5)
"""Across the head's island and down it: where the face is, how far it reaches, and how much denser it gets."""


@dataclass(frozen=True)
class Unwrapped:
    """The triangles of a head that are tracked, and their corners in the map."""

    faces: NDArray[np.int64]
    """[T] of the head's triangles."""
    uv: NDArray[np.float64]
    """[T, 3, 2] of their corners, v upwards."""


def unwrap(head: Head) -> Unwrapped:
    """Lay the head's skin, eyes, teeth and tongue out side by side."""
    uv = np.full((len(head.triangles), 3, 2), np.nan)
    skin = head.parts == SKIN
    middle = head.texture.mean(1)
    for name, (source, target) in ISLANDS.items():
        left, bottom, right, top = source
        here = (middle[:, 0] > left) & (middle[:, 0] < right) & (middle[:, 1] > bottom) & (middle[:, 1] < top)
        corners = head.texture[skin & here].astype(float)
        across, along = corners[..., 0], corners[..., 1]
        if name == "head":  # it lies on its side there, the chin to the right
            across, along = corners[..., 1], 1 - corners[..., 0]
        across, along = _stretched(across), _stretched(along)
        if name == "head":
            across, along = _denser(across, *FACE_ACROSS), _denser(along, *FACE_ALONG)
        uv[skin & here] = _into(target, np.stack([across, along], -1))
    for side, box in enumerate(EYE_BOXES):
        ball = (head.parts == EYES) & (head.eye_of_vertex[head.triangles[:, 0]] == side)
        flat = _flattened(head.vertices[head.triangles[ball]] - head.eye_centers[side], head.eye_axes[side])
        flat[(np.linalg.norm(flat, axis=-1) > 1).any(1)] = np.nan
        uv[ball] = _into(box, 0.5 + 0.5 * flat)
    for part, box in ((TEETH, TEETH_BOX), (TONGUE, TONGUE_BOX)):
        corners = head.texture[head.parts == part].astype(float)
        low, high = corners.min((0, 1)), corners.max((0, 1))
        uv[head.parts == part] = _into(box, (corners - low) / (high - low))
    faces = np.flatnonzero(np.isfinite(uv).all((1, 2)))
    return Unwrapped(faces, uv[faces])


def _stretched(values: Floats) -> Floats:
    return (values - values.min()) / (values.max() - values.min())


def _denser(values: Floats, middle: float, reach: float, gain: float) -> Floats:
    """Values in 0..1 moved so that those near ``middle`` get more room; their order stays."""
    grid = np.linspace(0, 1, 513)
    room = np.cumsum(1 + gain * np.exp(-(((grid - middle) / reach) ** 4)))
    return np.interp(values, grid, (room - room[0]) / (room[-1] - room[0]))


def _flattened(offsets: Floats, axis: Floats) -> Floats:
    """[T, 3, 2] points of a ball around its pupil: the angle becomes the distance, 1 at EYE_REACH_RAD."""
    unit = offsets / np.maximum(np.linalg.norm(offsets, axis=-1, keepdims=True), 1e-12)
    upright = np.cross(axis, [1.0, 0, 0])
    angle = np.arccos(np.clip(unit @ axis, -1, 1)) / EYE_REACH_RAD
    around = np.arctan2(unit @ upright, unit[..., 0])
    return angle[..., None] * np.stack([np.cos(around), np.sin(around)], -1)


def _into(box: Box, values: Floats) -> Floats:
    left, bottom, right, top = box
    return np.array([left, bottom]) + values * np.array([right - left, top - bottom])
