"""The sum in equation 1, at the speed of memory: every number of a basis is read once, on all cores."""

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
_BLOCK = 4096
"""Columns that one core sums at a time: 16 kB of sums and four rows of as much stay in its nearest caches."""


@numba.njit(cache=True, parallel=True, fastmath=True)
def blend(weights: Floats, rows: Floats, out: Floats) -> None:
    """out = weights @ rows[: len(weights)], in place.

    Against BLAS with one thread (which the command sets, as idle BLAS workers starve the rasteriser) this takes half
    the time on two cores.

    Args:
        weights: [m], m >= 1.
        rows: [K, W], K >= m; rows behind the first m are not read.
        out: [W], overwritten.
    """
    width, count = out.shape[0], weights.shape[0]
    for block in numba.prange((width + _BLOCK - 1) // _BLOCK):
        start = block * _BLOCK
        end = min(width, start + _BLOCK)
        sums, first = out[start:end], rows[0, start:end]
        for i in range(end - start):
            sums[i] = weights[0] * first[i]
        j = 1
        while j + 3 < count:  # four rows in one pass: the sums are read and written a quarter as often
            a, b, c, d = weights[j], weights[j + 1], weights[j + 2], weights[j + 3]
            ra, rb, rc, rd = rows[j, start:end], rows[j + 1, start:end], rows[j + 2, start:end], rows[j + 3, start:end]
            for i in range(end - start):
                sums[i] += a * ra[i] + b * rb[i] + c * rc[i] + d * rd[i]
            j += 4
        while j < count:
            w, row = weights[j], rows[j, start:end]
            for i in range(end - start):
                sums[i] += w * row[i]
            j += 1
