"""A z-buffer for triangle meshes: which triangle, and where in it, each pixel sees."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.camera import Camera


def see(
    vertices: Floats, triangles: NDArray[np.int64], camera: Camera
) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.float32]]:
    """Nearest triangle [H, W] (-1: none), its barycentric weights [H, W, 3] (perspective-correct), depth [H, W]."""
    world_to_camera = camera.world_to_camera
    points = vertices @ world_to_camera[:3, :3].T + world_to_camera[:3, 3]
    depth = np.maximum(points[:, 2], 1e-6)
    x = camera.fx * points[:, 0] / depth + camera.cx
    y = camera.fy * points[:, 1] / depth + camera.cy
    seen = np.full((camera.height, camera.width), -1, np.int32)
    weights = np.zeros((camera.height, camera.width, 3), np.float32)
    nearest = np.full((camera.height, camera.width), np.inf, np.float32)
    _rasterize(x, y, points[:, 2], triangles, seen, weights, nearest)
    return seen, weights, nearest


@njit(cache=True)
def _rasterize(x, y, z, triangles, seen, weights, nearest):
    height, width = seen.shape
    for f in range(len(triangles)):
        a, b, c = triangles[f]
        if z[a] <= 1e-3 or z[b] <= 1e-3 or z[c] <= 1e-3:
            continue
        area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
        if abs(area) < 1e-12:
            continue
        left = max(0, int(min(x[a], x[b], x[c]) - 0.5))
        right = min(width - 1, int(max(x[a], x[b], x[c]) + 0.5))
        top = max(0, int(min(y[a], y[b], y[c]) - 0.5))
        bottom = min(height - 1, int(max(y[a], y[b], y[c]) + 0.5))
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                px = column + 0.5
                py = row + 0.5
                v = ((px - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (py - y[a])) / area
                w = ((x[b] - x[a]) * (py - y[a]) - (px - x[a]) * (y[b] - y[a])) / area
                u = 1 - v - w
                if u < -1e-9 or v < -1e-9 or w < -1e-9:
                    continue
                depth = 1 / (u / z[a] + v / z[b] + w / z[c])
                if depth < nearest[row, column]:
                    nearest[row, column] = depth
                    seen[row, column] = f
                    weights[row, column, 0] = u / z[a] * depth
                    weights[row, column, 1] = v / z[b] * depth
                    weights[row, column, 2] = w / z[c] * depth
