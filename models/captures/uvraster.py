"""Which triangle of a UV atlas covers which texel."""

import numba
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats


def cover(uv: Floats, triangles: NDArray[np.integer], size: int) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """The triangle under the middle of each texel, and where in it.

    Args:
        uv: [C, 2] corners in [0, 1], v upwards; what lies outside the square is left out.
        triangles: [T, 3] indices into ``uv``; those without area cover nothing, and of several the last one counts.
        size: texels along a side; the first row is the uppermost (v near 1).

    Returns:
        [size, size] indices of triangles, -1 where there is none; [size, size, 3] barycentric coordinates.
    """
    owners = np.full((size, size), -1, np.int32)
    places = np.zeros((size, size, 3), np.float32)
    corners = np.stack([uv[:, 0], 1 - uv[:, 1]], -1).astype(np.float64) * size - 0.5
    _cover(corners, np.ascontiguousarray(triangles, np.int64), owners, places)
    return owners, places


@numba.njit(cache=True)
def _cover(corners, triangles, owners, places):
    size = len(owners)
    for t in range(len(triangles)):
        ax, ay = corners[triangles[t, 0]]
        bx, by = corners[triangles[t, 1]]
        cx, cy = corners[triangles[t, 2]]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if not abs(area) > 1e-12:
            continue
        left, right = max(0, int(np.ceil(min(ax, bx, cx)))), min(size - 1, int(np.floor(max(ax, bx, cx))))
        top, bottom = max(0, int(np.ceil(min(ay, by, cy)))), min(size - 1, int(np.floor(max(ay, by, cy))))
        for y in range(top, bottom + 1):
            for x in range(left, right + 1):
                first = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area
                second = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area
                third = 1 - first - second
                if min(first, second, third) >= -1e-9:
                    owners[y, x] = t
                    places[y, x, 0], places[y, x, 1], places[y, x, 2] = first, second, third
