"""Depth order, stable and finer than single precision: engines that sort alike blend alike."""

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

_BUCKETS = 1 << 16


def back_to_front(depths: ArrayLike) -> NDArray[np.int32]:
    """Indices of the splats with depth > 0, far to near.

    It is the exact reverse of near to far with ties in the order of their indices. ``depths`` [N] in metres; splats
    that are not to be drawn have depth 0.
    """
    metres = np.ascontiguousarray(depths, np.float64)
    orders = np.empty((2, len(metres)), np.int32)
    visible = front_to_back(metres, orders)
    return orders[0, :visible][::-1].copy()


@numba.njit(cache=True)
def front_to_back(depths, orders):
    """Write the indices of splats with depth > 0, near to far, into orders[0]; returns how many.

    ``depths`` float64 [N], ``orders`` int32 [2, N] (the second row is working space). Positive floats sort like their
    bits: three stable 16-bit radix passes over the upper 48, which tells depths apart that differ by 1.5e-11 of
    themselves. The 24 bits of single precision swap enough neighbours of a dense head to be seen at 78 dB.
    """
    keys = depths.view(np.uint64)
    first, second = orders[0], orders[1]
    counts = np.zeros((3, _BUCKETS + 1), np.int64)
    visible = 0
    for i in range(len(keys)):
        if depths[i] > 0:
            for digit in range(3):
                counts[digit, ((keys[i] >> np.uint64(16 * digit + 16)) & np.uint64(0xFFFF)) + np.uint64(1)] += 1
            second[visible] = i
            visible += 1
    for digit in range(3):
        starts, shift = counts[digit], np.uint64(16 * digit + 16)
        for k in range(_BUCKETS):
            starts[k + 1] += starts[k]
        source, target = (second, first) if digit % 2 == 0 else (first, second)
        for j in range(visible):
            bucket = (keys[source[j]] >> shift) & np.uint64(0xFFFF)
            target[starts[bucket]] = source[j]
            starts[bucket] += 1
    return visible
