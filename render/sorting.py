"""Depth order, exact and stable: engines that sort alike blend alike."""

import numba
import numpy as np
from numpy.typing import NDArray


def back_to_front(depths: NDArray[np.float32]) -> NDArray[np.int32]:
    """Indices of the splats with depth > 0, far to near.

    It is the exact reverse of near to far with ties in the order of their indices. ``depths`` [N] in metres; splats
    that are not to be drawn have depth 0.
    """
    orders = np.empty((2, len(depths)), np.int32)
    visible = front_to_back(np.ascontiguousarray(depths, np.float32), orders)
    return orders[0, :visible][::-1].copy()


@numba.njit(cache=True)
def front_to_back(depths, orders):
    """Write the indices of splats with depth > 0, near to far, into orders[0]; returns how many.

    ``depths`` float32 [N], ``orders`` int32 [2, N] (the second row is working space). Two 16-bit radix passes over
    the bits, since positive floats sort like their bits; each pass is stable, so the whole is.
    """
    keys = depths.view(np.uint32)
    first, second = orders[0], orders[1]
    low, high = np.zeros(65537, np.int64), np.zeros(65537, np.int64)
    visible = 0
    for i in range(len(keys)):
        if depths[i] > 0:
            low[(keys[i] & 0xFFFF) + 1] += 1
            high[(keys[i] >> 16) + 1] += 1
            visible += 1
    for k in range(65536):
        low[k + 1] += low[k]
        high[k + 1] += high[k]
    for i in range(len(keys)):
        if depths[i] > 0:
            key = keys[i] & 0xFFFF
            second[low[key]] = i
            low[key] += 1
    for j in range(visible):
        key = keys[second[j]] >> 16
        first[high[key]] = second[j]
        high[key] += 1
    return visible
