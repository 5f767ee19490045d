"""What each vertex sees of the lamps: one depth map for each direction of light, looked up softly."""

import numba
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .lamps import Lighting

MAP_SIZE = 256
MIDDLE = np.array([0.0, -0.03, 0.0], np.float32)
REACH_M = 0.25
"""Half the width of a depth map: the head and the top of the shoulders."""
BIAS_M = 1.6e-3
LIFT_M = 1.2e-3
"""A vertex is looked up so far off its surface, that it does not shade itself."""


def arriving(
    vertices: Floats, normals: Floats, blockers: NDArray[np.integer], bias: Floats, lighting: Lighting
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """The light at each vertex, less what the head itself blocks.

    Args:
        vertices: [V, 3] metres.
        normals: [V, 3] unit.
        blockers: [B, 3] the triangles that are in the way of light.
        bias: [V] metres added to BIAS_M: how deep a vertex may lie in what surrounds it, as hair does.
        lighting: the lamps.

    Returns:
        irradiance / pi [V, 3]; its mean direction [V, 3], not of unit length: shorter where light comes from all
        sides; and the share of each lamp [V, lamps + 1] that is seen, the room last.
    """
    directions = lighting.toward
    lamps = len(lighting.lobes) + 1
    count = np.bincount(lighting.lamp, minlength=lamps).astype(np.float32)
    seen = np.empty((len(directions), len(vertices)), np.float32)
    points = np.ascontiguousarray(vertices, np.float32)
    _look(points, np.ascontiguousarray(normals, np.float32), blockers, np.asarray(bias, np.float32), directions, seen)
    light = np.zeros((len(vertices), 3), np.float32)
    mean = np.zeros((len(vertices), 3), np.float32)
    shares = np.zeros((len(vertices), lamps), np.float32)
    _gather(
        np.ascontiguousarray(normals, np.float32),
        seen,
        directions,
        lighting.radiance,
        lighting.bounced,
        lighting.lamp,
        light,
        mean,
        shares,
    )
    return light, mean, shares / count


@numba.njit(cache=True, parallel=True, fastmath=True)
def _look(vertices, normals, blockers, bias, directions, seen):
    size = MAP_SIZE
    scale = size / (2 * REACH_M)
    for d in numba.prange(len(directions)):
        lx, ly, lz = directions[d]
        # two axes across the light
        if abs(lx) < 0.7:
            ax, ay, az = 0.0, lz, -ly
        else:
            ax, ay, az = -lz, 0.0, lx
        length = np.sqrt(ax * ax + ay * ay + az * az)
        ax, ay, az = ax / length, ay / length, az / length
        bx, by, bz = ly * az - lz * ay, lz * ax - lx * az, lx * ay - ly * ax
        x = np.empty(len(vertices), np.float32)
        y = np.empty(len(vertices), np.float32)
        z = np.empty(len(vertices), np.float32)
        for v in range(len(vertices)):
            px, py, pz = vertices[v, 0] - MIDDLE[0], vertices[v, 1] - MIDDLE[1], vertices[v, 2] - MIDDLE[2]
            x[v] = (px * ax + py * ay + pz * az) * scale + 0.5 * size
            y[v] = (px * bx + py * by + pz * bz) * scale + 0.5 * size
            z[v] = px * lx + py * ly + pz * lz
        nearest = np.full((size, size), -1e9, np.float32)
        for t in range(len(blockers)):
            a, b, c = blockers[t, 0], blockers[t, 1], blockers[t, 2]
            area = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
            if abs(area) < 1e-9:
                continue
            left, right = (
                max(0, int(np.ceil(min(x[a], x[b], x[c]) - 0.5))),
                min(size - 1, int(max(x[a], x[b], x[c]) - 0.5)),
            )
            top, bottom = (
                max(0, int(np.ceil(min(y[a], y[b], y[c]) - 0.5))),
                min(size - 1, int(max(y[a], y[b], y[c]) - 0.5)),
            )
            for row in range(top, bottom + 1):
                for column in range(left, right + 1):
                    qx, qy = column + 0.5, row + 0.5
                    v1 = ((qx - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (qy - y[a])) / area
                    v2 = ((x[b] - x[a]) * (qy - y[a]) - (qx - x[a]) * (y[b] - y[a])) / area
                    if v1 < -1e-5 or v2 < -1e-5 or v1 + v2 > 1.00001:
                        continue
                    depth = z[a] + v1 * (z[b] - z[a]) + v2 * (z[c] - z[a])
                    if depth > nearest[row, column]:
                        nearest[row, column] = depth
        for v in range(len(vertices)):
            nx, ny, nz = normals[v, 0], normals[v, 1], normals[v, 2]
            qx = x[v] + LIFT_M * scale * (nx * ax + ny * ay + nz * az) - 0.5
            qy = y[v] + LIFT_M * scale * (nx * bx + ny * by + nz * bz) - 0.5
            depth = z[v] + LIFT_M * (nx * lx + ny * ly + nz * lz) + BIAS_M + bias[v]
            column, row = int(np.floor(qx)), int(np.floor(qy))
            fx, fy = qx - column, qy - row
            share = 0.0
            for dy in range(2):
                for dx in range(2):
                    r, q = row + dy, column + dx
                    weight = (fx if dx else 1 - fx) * (fy if dy else 1 - fy)
                    if r < 0 or q < 0 or r >= size or q >= size or nearest[r, q] < depth:
                        share += weight
            seen[d, v] = share


@numba.njit(cache=True, parallel=True, fastmath=True)
def _gather(normals, seen, directions, radiance, bounced, lamp, light, mean, shares):
    for v in numba.prange(len(normals)):
        for d in range(len(directions)):
            facing = (
                normals[v, 0] * directions[d, 0] + normals[v, 1] * directions[d, 1] + normals[v, 2] * directions[d, 2]
            )
            shares[v, lamp[d]] += seen[d, v]
            if facing <= 0:
                continue
            share = seen[d, v]
            weight = 0.0
            for k in range(3):
                value = (share * radiance[d, k] + (1 - share) * bounced[d, k]) * facing
                light[v, k] += value
                weight += value
            for k in range(3):
                mean[v, k] += weight * directions[d, k]
