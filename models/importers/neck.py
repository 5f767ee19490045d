"""Where a head turns that came without a neck, and which of its splats turn with it."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..posing import NECK_PIVOT

PIVOT = np.array(NECK_PIVOT, np.float32)
"""Importers move their heads so that their pivot lies here, metres, canonical space."""
CHIN = -0.115
"""Height of the chin, metres, canonical space."""
_FREE, _BEND = -0.065, 0.085
"""From this height on a splat follows the head; this far below it, not at all. Metres."""
_SLANT = 0.35
"""The nape reaches higher than the throat: metres of height by metre of depth, up to 5 cm."""


def bending(positions: Floats) -> NDArray[np.float32]:
    """[N] share of the head's pose of splats at ``positions`` [N, 3], canonical space: 1 head, 0 shoulders.

    It rises smoothly along the neck, so that no seam opens where skin, hair and clothes meet.
    """
    slant = _SLANT * np.clip(positions[:, 2], -0.05, 0.05)
    share = np.clip((positions[:, 1] + slant - _FREE + _BEND) / _BEND, 0, 1)
    return (share * share * (3 - 2 * share)).astype(np.float32)
