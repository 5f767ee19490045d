"""Expressions that the face tracker reads as a nod: raised brows tip a head that does not move, a smile lifts it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import arkit
from ..gem import Gem

Floats = NDArray[np.floating]

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
SHARE = 0.5
"""So much of it is taken off a driver's turn. Between avatars all of it would be a little nearer to the truth; but what
a person's expression is, is itself only read, and people were not among those measured."""

LEAST_TOLD = 0.01
"""Movements that an avatar's shapes make less than this share of their greatest, in sigmas, tell nothing: on an avatar
of which a shape hardly moves anything, any tremble would be a nod."""


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
        upright = np.array(turn, float)
        upright[0] -= self.slopes @ (coefficients - self.rest)
        return upright


def nodding_of(gem: Gem) -> Nodding:
    """For the drivers of an avatar; nothing is taken off where the avatar does not know ARKit's shapes."""
    rest = gem.rest_coefficients
    if gem.arkit_weights is None:
        return Nodding(rest, np.zeros(len(rest)))
    pitch = np.radians([READ_AS_PITCH_DEG.get(name, 0.0) for name in arkit.NAMES])
    told = np.linalg.pinv(gem.arkit_weights.astype(float) / gem.sigma, rcond=LEAST_TOLD) @ pitch
    return Nodding(rest, SHARE * told / gem.sigma)
