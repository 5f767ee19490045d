"""Distances on the metric mesh that say directly what a part of the face does, in centimetres."""

from math import dist, hypot

import numpy as np
from numpy.typing import NDArray

from .points import LEFT_EYE_INNER, LEFT_EYE_OUTER, RIGHT_EYE_INNER, RIGHT_EYE_OUTER

MEASURES = (
    "lip_gap",
    "mouth_width",
    "lip_height",
    "lip_protrusion",
    "jaw_drop",
    "jaw_side",
    "mouth_side",
    "right_corner_height",
    "left_corner_height",
    "right_lid_gap",
    "left_lid_gap",
    "right_inner_brow",
    "left_inner_brow",
    "right_middle_brow",
    "left_middle_brow",
    "right_outer_brow",
    "left_outer_brow",
    "brow_distance",
)
"""Order of the vector that ``measure`` gives."""
_LIDS = ((159, 145), (158, 153), (160, 144), (386, 374), (385, 380), (387, 373))
"""Upper and lower lid, three pairs of the right eye, then of the left."""
_BROWS = ((55, 107), (285, 336), (52, 105), (282, 334), (46, 70), (276, 300))
"""Lower and upper edge: inner right and left, middle right and left, outer right and left."""
_UPPER_LIP, _LOWER_LIP, _LIP_TOP, _LIP_BOTTOM = 13, 14, 0, 17
_RIGHT_CORNER, _LEFT_CORNER = 61, 291
_NOSE_BASE, _CHIN = 2, 152


def measure(metric_mesh: NDArray[np.float64]) -> NDArray[np.float64]:
    """[18] in the order of MEASURES, cm, of landmarks [468, 3] in the canonical frame.

    Heights of brows are above the line through the eye corners of their side; heights of mouth corners above the base
    of the nose; sides grow to the person's left.
    """
    x, y, z = metric_mesh.T
    right_eye = (y[RIGHT_EYE_OUTER] + y[RIGHT_EYE_INNER]) / 2
    left_eye = (y[LEFT_EYE_INNER] + y[LEFT_EYE_OUTER]) / 2
    # one at a time, Python's floats are quicker than arrays of two or three
    lids = [hypot(y[upper] - y[lower], z[upper] - z[lower]) for upper, lower in _LIDS]
    brows = [(y[lower] + y[upper]) / 2 for lower, upper in _BROWS]
    return np.array(
        [
            dist(metric_mesh[_UPPER_LIP], metric_mesh[_LOWER_LIP]),
            dist(metric_mesh[_RIGHT_CORNER], metric_mesh[_LEFT_CORNER]),
            y[_LIP_TOP] - y[_LIP_BOTTOM],
            (z[_LIP_TOP] + z[_LIP_BOTTOM]) / 2 - z[_NOSE_BASE],
            y[_NOSE_BASE] - y[_CHIN],
            x[_CHIN] - x[_NOSE_BASE],
            (x[_UPPER_LIP] + x[_LOWER_LIP]) / 2 - x[_NOSE_BASE],
            y[_RIGHT_CORNER] - y[_NOSE_BASE],
            y[_LEFT_CORNER] - y[_NOSE_BASE],
            sum(lids[:3]) / 3,
            sum(lids[3:]) / 3,
            *(brow - eye for brow, eye in zip(brows, (right_eye, left_eye) * 3, strict=True)),
            dist(*(metric_mesh[lower] + metric_mesh[upper] for lower, upper in _BROWS[:2])) / 2,
        ],
        np.float64,
    )
