"""Smooth random fields in space, the same on every machine: what makes skin uneven."""

import numpy as np
from numba import njit

from ...render.arrays import Floats


@njit(cache=True)
def _hashed(x, y, z, seed):
    """A fixed random number in [0, 1) for an integer cell (splitmix64's finaliser)."""
    h = np.uint64(x) * np.uint64(0x9E3779B97F4A7C15)
    h ^= np.uint64(y) * np.uint64(0xC2B2AE3D27D4EB4F)
    h ^= np.uint64(z) * np.uint64(0x165667B19E3779F9)
    h ^= np.uint64(seed) * np.uint64(0xD6E8FEB86659FD93) + np.uint64(1)
    h = (h ^ (h >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    h = (h ^ (h >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    h ^= h >> np.uint64(31)
    return float(h >> np.uint64(11)) / 9007199254740992.0


def value_noise(points: Floats, wavelength: float, seed: int) -> Floats:
    """Noise [N] in about [-1, 1], smooth over ``wavelength`` (unit of ``points`` [N, 3])."""
    return _value_noise(np.ascontiguousarray(points, np.float64) / wavelength, seed)


@njit(cache=True)
def _value_noise(scaled, seed):
    out = np.empty(len(scaled))
    cell = np.empty(3, np.int64)
    t = np.empty(3)
    for i in range(len(scaled)):
        for k in range(3):
            cell[k] = int(np.floor(scaled[i, k]))
            f = scaled[i, k] - cell[k]
            t[k] = f * f * (3 - 2 * f)
        total = 0.0
        for corner in range(8):
            dx, dy, dz = corner & 1, (corner >> 1) & 1, (corner >> 2) & 1
            weight = (t[0] if dx else 1 - t[0]) * (t[1] if dy else 1 - t[1]) * (t[2] if dz else 1 - t[2])
            total += weight * _hashed(cell[0] + dx, cell[1] + dy, cell[2] + dz, seed)
        out[i] = 2.4 * (total - 0.5)
    return out


def spots(points: Floats, spacing: float, radius: float, seed: int) -> Floats:
    """[N] in [0, 1]: soft round spots, one per cell of ``spacing`` at a random place, up to ``radius`` wide."""
    return _spots(np.ascontiguousarray(points, np.float64), spacing, radius, seed)


@njit(cache=True)
def _spots(points, spacing, radius, seed):
    out = np.zeros(len(points))
    for i in range(len(points)):
        bx = int(np.floor(points[i, 0] / spacing))
        by = int(np.floor(points[i, 1] / spacing))
        bz = int(np.floor(points[i, 2] / spacing))
        for x in range(bx - 1, bx + 2):
            for y in range(by - 1, by + 2):
                for z in range(bz - 1, bz + 2):
                    dx = points[i, 0] - (x + _hashed(x, y, z, seed)) * spacing
                    dy = points[i, 1] - (y + _hashed(x, y, z, seed + 1)) * spacing
                    dz = points[i, 2] - (z + _hashed(x, y, z, seed + 2)) * spacing
                    size = radius * (0.35 + 0.65 * _hashed(x, y, z, seed + 3) ** 2)
                    strength = 0.3 + 0.7 * _hashed(x, y, z, seed + 4)
                    value = strength * np.exp(-1.5 * (dx * dx + dy * dy + dz * dz) / size**2)
                    out[i] = max(out[i], value)
    return out
