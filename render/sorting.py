"""Depth order, stable and finer than single precision: engines that sort alike blend alike."""

import numba
import numpy as np

_DIGITS, _BITS = 4, 12
"""Passes, and bits that each sorts by: 48 in all. With 16 the counters alone, 1.5 MB, take longer than the splats."""
_MASK = np.uint64((1 << _BITS) - 1)


@numba.njit(cache=True)
def front_to_back(depths, orders):
    """Write the indices of splats with depth > 0, near to far, into orders[0]; returns how many.

    ``depths`` float64 [N], 0 for splats that are not to be drawn, ``orders`` int32 [2, N] (the second row is working
    space). Ties are in the order of their indices. Positive floats sort like their bits: stable radix passes over the
    upper 48, which tells depths apart that differ by 1.5e-11 of themselves. The 24 bits of single precision swap enough
    neighbours of a dense head to be seen at 78 dB.
    """
    keys = depths.view(np.uint64)
    first, second = orders[0], orders[1]
    counts = np.zeros((_DIGITS, 1 << _BITS), np.int32)
    visible = 0
    for i in range(len(keys)):
        if depths[i] > 0:
            for digit in range(_DIGITS):
                counts[digit, (keys[i] >> _shift(digit)) & _MASK] += 1
            first[visible] = i
            visible += 1
    for digit in range(_DIGITS):
        starts, shift = counts[digit], _shift(digit)
        before = 0
        for k in range(1 << _BITS):
            starts[k], before = before, before + starts[k]
        source, target = (first, second) if digit % 2 == 0 else (second, first)
        for j in range(visible):
            bucket = (keys[source[j]] >> shift) & _MASK
            target[starts[bucket]] = source[j]
            starts[bucket] += 1
    return visible


@numba.njit(cache=True, inline="always")
def _shift(digit):
    return np.uint64(64 - _BITS * (_DIGITS - digit))
