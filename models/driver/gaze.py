"""Where the eyes look, geometrically: the iris inside its eye, in the frame of the head."""

import numpy as np
from numpy.typing import NDArray

from .points import LEFT_EYE_INNER, LEFT_EYE_OUTER, RIGHT_EYE_INNER, RIGHT_EYE_OUTER

EYEBALL_RADIUS_CM = 1.2
"""Radius of the human eye; the iris moves on this sphere."""
GAZE = ("right_horizontal", "right_vertical", "left_horizontal", "left_vertical")
"""Order of a gaze vector."""
_RIM = 5
"""Landmarks of one iris: the centre and four points on its rim."""


def eye_gaze(metric_mesh: NDArray[np.float64], metric_irises: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gaze angles [4] in radians, in the order of GAZE: horizontal grows to the person's left, vertical upwards.

    The iris is measured from the middle of its eye corners, which do not move with the gaze as the lids do, and its
    offset is read as an angle on a sphere of EYEBALL_RADIUS_CM. The rest position differs between people and trackers:
    subtract the neutral's. Arguments as in ``FaceObservation``; the head pose is already taken off there.
    """
    right = metric_irises[:_RIM].mean(0) - (metric_mesh[RIGHT_EYE_OUTER] + metric_mesh[RIGHT_EYE_INNER]) / 2
    left = metric_irises[_RIM:].mean(0) - (metric_mesh[LEFT_EYE_OUTER] + metric_mesh[LEFT_EYE_INNER]) / 2
    offsets = np.array([right[0], right[1], left[0], left[1]])
    return np.arcsin(np.clip(offsets / EYEBALL_RADIUS_CM, -1, 1))


def joined(gaze: NDArray[np.floating]) -> NDArray[np.floating]:
    """One (horizontal, vertical) [..., 2] of both eyes' gaze [..., 4]: they look at one thing, and half the noise."""
    return (gaze[..., :2] + gaze[..., 2:]) / 2
