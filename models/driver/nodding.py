"""Expressions that the face tracker reads as a nod: raised brows tip a head that does not move, a smile lifts it."""

from dataclasses import dataclass

import numpy as np

from ...render.arrays import Floats
from .. import arkit
from ..gem import Gem

READ_AS_PITCH_DEG = {
    "browInnerUp": -2.6,
    "browDownLeft": 0.6,
    "browDownRight": 0.6,
    "jawOpen": -0.7,
    "mouthClose": -3.0,
    "mouthFrownLeft": -1.4,
    "mouthFrownRight": -1.4,
    "mouthLeft": 1.4,
    "mouthRight": 1.4,
    "mouthRollLower": -1.2,
    "mouthRollUpper": 2.0,
    "mouthSmileLeft": 1.7,
    "mouthSmileRight": 1.7,
    "mouthUpperUpLeft": -1.1,
    "mouthUpperUpRight": -1.1,
}
"""ARKit shape -> degrees by which the pitch of a head that stays still is read off, at weight 1: alike on three heads
that differ, so a property of the tracker (tests/bench/nodding.py)."""
LEAST_TOLD, LEAST_TOLD_SIGMAS = 0.01, 0.1
"""Movements that an avatar's shapes make less than this share of their greatest, or less than so many sigmas, tell
nothing: on an avatar of which a shape hardly moves anything, any tremble would be a nod."""
MOST_DEG = 10.0
"""No face seems to nod further: all shapes together that lift it come to 9 degrees, those that tip it to 12."""


@dataclass(frozen=True)
class Nodding:
    """What to take off a driver's turn."""

    rest: Floats
    """[coefficients] the neutral expression."""
    slopes: Floats
    """[coefficients] radians of pitch for a unit of each coefficient away from it."""

    def taken_off(self, turn: Floats, coefficients: Floats) -> Floats:
        """The head's rotation [3] from its neutral, as a rotation vector in radians, without what the expression that
        was read beside it, as ``coefficients`` [coefficients], only seems to nod."""
        most = np.radians(MOST_DEG)
        upright = np.array(turn, float)
        upright[0] -= np.clip(self.slopes @ (coefficients - self.rest), -most, most)
        return upright


def nodding_of(gem: Gem) -> Nodding:
    """For the drivers of an avatar; nothing is taken off where the avatar does not know ARKit's shapes."""
    rest = gem.rest_coefficients
    if gem.arkit_weights is None:
        return Nodding(rest, np.zeros(len(rest)))
    pitch = np.radians([READ_AS_PITCH_DEG.get(name, 0.0) for name in arkit.NAMES])
    moves = gem.arkit_weights.astype(float) / gem.sigma
    greatest = np.linalg.norm(moves, 2)
    least = max(LEAST_TOLD, LEAST_TOLD_SIGMAS / greatest) if greatest > 0 else 1.0
    return Nodding(rest, np.linalg.pinv(moves, rcond=least) @ pitch / gem.sigma)
