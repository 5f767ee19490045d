"""Distances on the metric mesh that say directly what a part of the face does, in centimetres."""

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
_LIDS = np.array([[159, 145], [158, 153], [160, 144], [386, 374], [385, 380], [387, 373]])
"""Upper and lower lid, three pairs of the right eye, then of the left."""
_BROWS = np.array([[55, 107], [285, 336], [52, 105], [282, 334], [46, 70], [276, 300]])
"""Lower and upper edge: inner right and left, middle right and left, outer right and left."""
_UPPER_LIP, _LOWER_LIP, _LIP_TOP, _LIP_BOTTOM = 13, 14, 0, 17
_RIGHT_CORNER, _LEFT_CORNER = 61, 291
_NOSE_BASE, _CHIN = 2, 152


def measure(metric_mesh: NDArray[np.float64]) -> NDArray[np.float64]:
    """[18] in the order of MEASURES, cm, of landmarks [468, 3] in the canonical frame.

    Heights of brows are above the line through the eye corners of their side; heights of mouth corners above the base
    of the nose; sides grow to the person's left.
    """
    mesh = metric_mesh
    lips, corners = mesh[[_UPPER_LIP, _LOWER_LIP]], mesh[[_RIGHT_CORNER, _LEFT_CORNER]]
    eyes = (
        (mesh[RIGHT_EYE_OUTER, 1] + mesh[RIGHT_EYE_INNER, 1]) / 2,
        (mesh[LEFT_EYE_INNER, 1] + mesh[LEFT_EYE_OUTER, 1]) / 2,
    )
    lids = np.linalg.norm(mesh[_LIDS[:, 0], 1:] - mesh[_LIDS[:, 1], 1:], axis=1).reshape(2, 3).mean(1)
    brows = mesh[_BROWS, 1].mean(1) - np.tile(eyes, 3)
    return np.array(
        [
            np.linalg.norm(lips[0] - lips[1]),
            np.linalg.norm(corners[0] - corners[1]),
            mesh[_LIP_TOP, 1] - mesh[_LIP_BOTTOM, 1],
            mesh[[_LIP_TOP, _LIP_BOTTOM], 2].mean() - mesh[_NOSE_BASE, 2],
            mesh[_NOSE_BASE, 1] - mesh[_CHIN, 1],
            mesh[_CHIN, 0] - mesh[_NOSE_BASE, 0],
            lips[:, 0].mean() - mesh[_NOSE_BASE, 0],
            *(corners[:, 1] - mesh[_NOSE_BASE, 1]),
            *lids,
            *brows,
            np.linalg.norm(mesh[_BROWS[0]].mean(0) - mesh[_BROWS[1]].mean(0)),
        ],
        np.float64,
    )
