"""The ring of cameras in front of the person."""

import numpy as np

from ...render.camera import Camera, orbit
from ..gem import Viewing

DISTANCE_M = 1.0
YAW_LIMIT_DEG = 80.0
PITCHES_DEG = (3.0, 20.0, -12.0, 8.0)
"""Heights that cameras take in turn, from one side to the other."""
HEAD_SHARE = 0.60
"""Of the picture's height that chin to crown fill."""


def rig(count: int, width: int, height: int, viewing: Viewing) -> tuple[Camera, ...]:
    """Cameras over the front half, from the person's right to the left, all looking at the middle of the head."""
    yaws = np.linspace(-YAW_LIMIT_DEG, YAW_LIMIT_DEG, count) if count > 1 else np.zeros(1)
    fov = 2 * np.degrees(np.arctan(viewing.head_height / HEAD_SHARE / 2 / DISTANCE_M))
    return tuple(
        orbit(viewing.target, DISTANCE_M, float(yaw), PITCHES_DEG[i % len(PITCHES_DEG)], float(fov), width, height)
        for i, yaw in enumerate(yaws)
    )


def frontal(cameras: tuple[Camera, ...]) -> int:
    """The camera that sees the face most from the front: the one to hold out."""
    away = [np.linalg.norm(camera.center[:2] / np.linalg.norm(camera.center)) for camera in cameras]
    return int(np.argmin(away))
