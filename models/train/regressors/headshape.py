"""Heads of other shapes out of one avatar: a smooth, symmetric displacement of its splats."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....render.arrays import Floats64
from ...gem import Viewing

BUMPS = 8
"""Places, on either side of the face, that stand out or back."""
SCALE_SPREAD = np.array([0.06, 0.05, 0.12])
"""Standard deviations of the logarithm of how wide, how high and how deep a head is, against the avatar's."""
SHIFT_SPREAD = np.array([0.018, 0.024, 0.036])
"""Standard deviations of how far a bump stands out, in heights of the head: across, up and forward."""
WIDTHS = (0.12, 0.3)
"""Standard deviations of a bump itself, in heights of the head, from ... to."""
REACH = np.array([0.3, 0.5, 0.15])
"""So far from the middle of the face bumps lie, in heights of the head."""
FORWARD = 0.3
"""The middle of the face lies so far before the middle of the head."""


@dataclass(frozen=True)
class HeadShape:
    """Another person's head: lengths are in heights of the avatar's head, from its middle."""

    scale: Floats64
    """[3] how much wider, higher and deeper."""
    centres: Floats64
    """[B, 3] of bumps on its left; on its right they are the same."""
    shifts: Floats64
    """[B, 3] how far each stands out."""
    widths: Floats64
    """[B] standard deviations."""

    def displacement(self, positions: NDArray[np.float32], viewing: Viewing) -> NDArray[np.float32]:
        """[N, 3] metres: where splats [N, 3] of the avatar at rest are on this head, against where they are."""
        places = (positions - np.asarray(viewing.target)) / viewing.head_height
        moved = places * (self.scale - 1)
        for side in (np.array([1.0, 1.0, 1.0]), np.array([-1.0, 1.0, 1.0])):
            away = places[:, None, :] - self.centres * side
            nearness = np.exp(-(away**2).sum(2) / (2 * self.widths**2))
            moved += nearness @ (self.shifts * side)
        return (moved * viewing.head_height).astype(np.float32)


def random_shape(rng: np.random.Generator) -> HeadShape:
    """Another person's, as noses, brows, chins, cheeks and skulls differ."""
    centres = rng.uniform(-REACH, REACH, (BUMPS, 3)) + np.array([0, 0, FORWARD])
    widths = rng.uniform(*WIDTHS, BUMPS)
    shifts = rng.normal(0, SHIFT_SPREAD, (BUMPS, 3))
    # bumps that lie on their own mirror image count twice
    shifts /= 1 + np.exp(-(centres[:, :1] ** 2) / (2 * widths[:, None] ** 2))
    return HeadShape(np.exp(rng.normal(0, SCALE_SPREAD)), centres, shifts, widths)
