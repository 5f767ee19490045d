"""Head motion out of frames: each is turned and moved rigidly until most of its splats lie where they first lay."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.gaussians import RawGaussians
from ...render.rotations import wxyz_from_matrix
from ..captures.headmotion import rigid

_ROUNDS = 8
_SAMPLE = 4000
"""So many splats are enough for six numbers."""
_FLOOR = 1e-4
"""Metres; what lies nearer than this counts in full."""


def held_still(frame: RawGaussians, first: RawGaussians) -> RawGaussians:
    """``frame`` [N] moved rigidly onto ``first`` [N], means and rotations alike.

    What moves by itself (lips, jaw, lids) counts little: the fit is repeated with each splat weighted down by how far
    off it was left (Cauchy weights), faint splats by their opacity.
    """
    step = max(1, len(first) // _SAMPLE)
    source, target = (x.positions[::step].astype(np.float64) for x in (frame, first))
    solid = 1 / (1 + np.exp(-first.opacity_logits[::step].astype(np.float64)))
    weights = solid
    turn, move = np.eye(3), np.zeros(3)
    for _ in range(_ROUNDS):
        turn, move = rigid(source, target, weights)
        off = np.linalg.norm(source @ turn.T + move - target, axis=1)
        weights = solid / (1 + (off / max(float(np.median(off)), _FLOOR)) ** 2)
    positions = (frame.positions @ turn.T + move).astype(np.float32)
    return RawGaussians(positions, turned(frame.wxyz, turn), frame.log_scales, frame.opacity_logits, frame.colors)


def turned(wxyz: Floats, rotation: Floats) -> NDArray[np.float32]:
    """Quaternions [N, 4] with a rotation matrix [3, 3] put before them."""
    w, x, y, z = wxyz_from_matrix(rotation)
    left = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])
    return (wxyz @ left.T).astype(np.float32)
