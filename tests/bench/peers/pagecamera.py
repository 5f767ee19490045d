"""Our camera and constants as the pages take them: three.js matrices, column after column, OpenGL's axes."""

from typing import Any

import numpy as np
from gemheads.render.camera import Camera
from gemheads.render.projection import DILATION
from numpy.typing import NDArray

NEAR, FAR = 0.05, 20.0
"""Metres; viewers drop what is outside, and no splat of a head is."""
SPLATS_ADDRESS = "/splats.ply"
_FLIP = np.diag([1.0, -1.0, -1.0, 1.0])
"""OpenCV's axes (y down, z forward) to OpenGL's (y up, z backward), and back."""


def settings_of(background: tuple[float, float, float]) -> dict[str, Any]:
    """What every page must agree on with our engines; ``background``: sRGB-encoded, in [0, 1]."""
    return {"splats": SPLATS_ADDRESS, "background": list(background), "dilation": float(DILATION)}


def lens_of(camera: Camera) -> dict[str, Any]:
    """The picture's size, the depth range, and the projection as 16 numbers."""
    return {
        "width": camera.width,
        "height": camera.height,
        "near": NEAR,
        "far": FAR,
        "projection": _columns(projection_of(camera)),
    }


def pose_of(camera: Camera) -> list[float]:
    """Camera to world as 16 numbers."""
    return _columns(np.linalg.inv(_FLIP @ camera.world_to_camera))


def projection_of(camera: Camera) -> NDArray[np.float64]:
    """[4, 4] from OpenGL's camera axes to clip space: the same pixels as ``fx, fy, cx, cy``, also off the middle."""
    matrix = np.zeros((4, 4))
    matrix[0, 0] = 2 * camera.fx / camera.width
    matrix[1, 1] = 2 * camera.fy / camera.height
    matrix[0, 2] = 1 - 2 * camera.cx / camera.width
    matrix[1, 2] = 2 * camera.cy / camera.height - 1
    matrix[2, 2:] = -(FAR + NEAR) / (FAR - NEAR), -2 * FAR * NEAR / (FAR - NEAR)
    matrix[3, 2] = -1
    return matrix


def _columns(matrix: NDArray[np.float64]) -> list[float]:
    return matrix.T.ravel().tolist()
