"""How much expression there is in coefficients: by sigma, and by how far splats move."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..gem import Gem


@dataclass(frozen=True)
class Extent:
    """RMS of coefficients away from something."""

    sigma: float
    """Over all coefficients, each in its own sigma: every component counts the same."""
    mm: float
    """Over all splats, how far they are moved, millimetres: what moves much counts much."""

    def over(self, whole: "Extent") -> "Extent":
        """As parts of another, in which there is some expression (else 0)."""
        return Extent(_share(self.sigma, whole.sigma), _share(self.mm, whole.mm))


def extent(away: NDArray[np.floating], gem: Gem) -> Extent:
    """Of coefficients [F, n] away from what they are held to, F at least 1. Components are orthonormal."""
    squares = (np.asarray(away, np.float64) ** 2).mean(0)
    moved = squares[gem.slices["position"]].sum() / len(gem)
    return Extent(float(np.sqrt((squares / gem.sigma**2).mean())), 1000 * float(np.sqrt(moved)))


def _share(part: float, whole: float) -> float:
    return part / whole if whole > 0 else 0.0
