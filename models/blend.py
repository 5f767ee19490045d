"""The sum in equation 1, and its gradient, at the speed of memory: every number of a basis is read once, on all cores.

Against BLAS with one thread (which the command sets, as idle BLAS workers starve the rasteriser) this takes half the
time on two cores.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from ..render.arrays import Floats32
from ..render.compiling import FLAT, WIDE, compile_ahead

_BLOCK = 4096
"""Columns that one core sums at a time: 16 kB of sums and four rows of as much stay in its nearest caches."""


def warm() -> None:
    """Compile what composing splats needs, or load it from disk, without running it."""
    columns, moving = numba.types.Array(numba.int32, 1, "C"), numba.types.Array(numba.boolean, 1, "C")
    compile_ahead(blend, FLAT, FLAT, WIDE, FLAT)
    compile_ahead(blend_columns, FLAT, FLAT, WIDE, columns, FLAT)
    compile_ahead(moving_columns, WIDE, moving)
    compile_ahead(gather, WIDE, columns, WIDE)


@numba.njit(cache=True, parallel=True, fastmath=True)
def blend(weights: Floats32, mean: Floats32, rows: Floats32, out: Floats32) -> None:
    """out = mean + weights @ rows[: len(weights)], in place.

    Args:
        weights: [m], m >= 0.
        mean: [W].
        rows: [K, W], K >= m; rows behind the first m are not read.
        out: [W], overwritten.
    """
    width = out.shape[0]
    for block in numba.prange((width + _BLOCK - 1) // _BLOCK):
        start = block * _BLOCK
        end = min(width, start + _BLOCK)
        sums = out[start:end]
        sums[:] = mean[start:end]
        _add(weights, rows, start, end, sums)


@numba.njit(cache=True, parallel=True, fastmath=True)
def blend_columns(weights: Floats32, mean: Floats32, rows: Floats32, columns: NDArray[np.int32], out: Floats32) -> None:
    """The same where most components are 0 in most places: out = mean, and there mean + weights @ rows[: len(weights)].

    Args:
        weights: [m], m >= 0.
        mean: [W].
        rows: [K, M], K >= m; rows behind the first m are not read.
        columns: [M] the places in ``out``, each once.
        out: [W], overwritten.
    """
    width, moving = out.shape[0], columns.shape[0]
    for block in numba.prange((width + _BLOCK - 1) // _BLOCK):
        start = block * _BLOCK
        end = min(width, start + _BLOCK)
        out[start:end] = mean[start:end]
    for block in numba.prange((moving + _BLOCK - 1) // _BLOCK):
        start = block * _BLOCK
        end = min(moving, start + _BLOCK)
        sums = np.zeros(end - start, np.float32)
        _add(weights, rows, start, end, sums)
        for i in range(end - start):
            out[columns[start + i]] += sums[i]


@numba.njit(cache=True, parallel=True, fastmath=True)
def correlate(rows: Floats32, values: Floats32, out: Floats32) -> None:
    """out = rows @ values, in place: how a gradient goes back through the sum.

    Args:
        rows: [K, W].
        values: [W].
        out: [K], overwritten.
    """
    width = values.shape[0]
    for j in numba.prange(rows.shape[0]):
        row, total = rows[j], 0.0
        for start in range(0, width, _BLOCK):  # short sums in float32, the long one in float64
            part = np.float32(0)
            for i in range(start, min(width, start + _BLOCK)):
                part += row[i] * values[i]
            total += part
        out[j] = total


@numba.njit(cache=True, parallel=True)
def moving_columns(rows: Floats32, moving: NDArray[np.bool_]) -> None:
    """``moving`` [W] = whether a column of ``rows`` [K, W] holds anything but 0 (NaN is something), in place."""
    width = moving.shape[0]
    for block in numba.prange((width + _BLOCK - 1) // _BLOCK):
        start = block * _BLOCK
        end = min(width, start + _BLOCK)
        moving[start:end] = False
        for j in range(rows.shape[0]):
            for i in range(start, end):
                moving[i] |= rows[j, i] != 0


@numba.njit(cache=True, parallel=True)
def gather(rows: Floats32, columns: NDArray[np.int32], out: Floats32) -> None:
    """out = rows[:, columns], in place. ``out`` [K, M]."""
    for j in numba.prange(rows.shape[0]):
        for i in range(columns.shape[0]):
            out[j, i] = rows[j, columns[i]]


@numba.njit(cache=True, fastmath=True, inline="always")
def _add(weights: Floats32, rows: Floats32, start: int, end: int, sums: Floats32) -> None:
    """Adds weights @ rows[:, start:end]."""
    count, j = weights.shape[0], 0
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
