"""Splats that hang in the air: reconstructions leave blobs where a head was never seen, and any turn shows them."""

from itertools import product

import numpy as np
from numpy.typing import NDArray

CELL = 0.01
"""Side of the cells in which splats are counted, metres."""


def neighbours(positions: NDArray[np.floating]) -> NDArray[np.int64]:
    """[N] how many splats at ``positions`` [N, 3], itself among them, lie in a splat's cell and the 26 around it."""
    cells = np.floor(positions.astype(np.float64) / CELL).astype(np.int64)
    cells -= cells.min(0) - 1
    sides = cells.max(0) + 2
    steps = np.array([sides[1] * sides[2], sides[2], 1])
    places = cells @ steps
    filled, counts = np.unique(places, return_counts=True)
    total = np.zeros(len(places), np.int64)
    for offset in product((-1, 0, 1), repeat=3):
        wanted = places + np.array(offset) @ steps
        at = np.minimum(np.searchsorted(filled, wanted), len(filled) - 1)
        total += np.where(filled[at] == wanted, counts[at], 0)
    return total
