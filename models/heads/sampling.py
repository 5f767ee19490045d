"""Points spread evenly over the head's surface: Poisson discs whose size follows importance."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...render.arrays import Floats


def scatter(
    corners: Floats, density: Floats, count: int, rng: np.random.Generator
) -> tuple[NDArray[np.int64], Floats, Floats]:
    """About ``count`` points over triangles [F, 3, 3], blue noise, with relative ``density`` [F] (0: none).

    Returns the triangle [N], barycentric weights [N, 3] and disc radius [N] (metres) of each point. No two points of
    the set are closer than the smaller of their radii. The count comes out within 2 %, never above.
    """
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    mass = area * density
    candidates = 14 * count
    steps = (np.arange(candidates) + rng.random(candidates)) / candidates
    triangle = np.searchsorted(np.cumsum(mass) / mass.sum(), steps).clip(0, len(mass) - 1)
    triangle = triangle[rng.permutation(candidates)]
    root, along = np.sqrt(rng.random(candidates)), rng.random(candidates)
    weights = np.stack([1 - root, root * (1 - along), root * along], 1)
    points = (corners[triangle] * weights[..., None]).sum(1)
    spacing = np.sqrt(mass.sum() / count / density[triangle])
    low, high = 0.5, 1.2
    for _ in range(9):
        middle = 0.5 * (low + high)
        kept = _eliminate(points, middle * spacing)
        if kept.sum() > count:
            low = middle
        else:
            high = middle
    kept = np.flatnonzero(_eliminate(points, high * spacing))
    return triangle[kept], weights[kept], (high * spacing)[kept]


@njit(cache=True)
def _eliminate(points, radius):
    """Which points survive when each, in order, is refused if one before it is closer than the smaller radius."""
    cell = 2.0 * np.median(radius)
    low = np.array([points[:, 0].min(), points[:, 1].min(), points[:, 2].min()]) - 1e-6
    nx = int((points[:, 0].max() - low[0]) / cell) + 1
    ny = int((points[:, 1].max() - low[1]) / cell) + 1
    nz = int((points[:, 2].max() - low[2]) / cell) + 1
    first = np.full(nx * ny * nz, -1, np.int64)
    following = np.full(len(points), -1, np.int64)
    kept = np.zeros(len(points), np.bool_)
    for i in range(len(points)):
        x = int((points[i, 0] - low[0]) / cell)
        y = int((points[i, 1] - low[1]) / cell)
        z = int((points[i, 2] - low[2]) / cell)
        reach = int(radius[i] / cell) + 1
        free = True
        for cx in range(max(0, x - reach), min(nx, x + reach + 1)):
            for cy in range(max(0, y - reach), min(ny, y + reach + 1)):
                for cz in range(max(0, z - reach), min(nz, z + reach + 1)):
                    j = first[(cx * ny + cy) * nz + cz]
                    while j >= 0 and free:
                        limit = min(radius[i], radius[j])
                        dx = points[i, 0] - points[j, 0]
                        dy = points[i, 1] - points[j, 1]
                        dz = points[i, 2] - points[j, 2]
                        if dx * dx + dy * dy + dz * dz < limit * limit:
                            free = False
                        j = following[j]
        if free:
            kept[i] = True
            following[i] = first[(x * ny + y) * nz + z]
            first[(x * ny + y) * nz + z] = i
    return kept
