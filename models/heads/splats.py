"""Splats that ride on the head's triangles: any pose of the mesh becomes RawGaussians."""

from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.gaussians import RawGaussians


@dataclass(frozen=True)
class Rider:
    """N splats, each fixed to one triangle."""

    corners: NDArray[np.int64]
    """[N, 3] vertices of the triangle."""
    weights: NDArray[np.float32]
    """[N, 3] barycentric."""
    tangent: NDArray[np.float32]
    """[N, 2] unit tangent at rest as a sum of the triangle's two edges (1 - 0, 2 - 0)."""
    bitangent: NDArray[np.float32]
    """[N, 2] the same for the unit bitangent."""
    lift: NDArray[np.float32]
    """[N] metres above the triangle."""
    sigma: NDArray[np.float32]
    """[N, 3] standard deviations at rest along tangent, bitangent and normal, metres."""
    opacity: NDArray[np.float32]
    """[N] in (0, 1)."""
    color: NDArray[np.float32]
    """[N, 3] sRGB in [0, 1]."""
    part: NDArray[np.uint8]
    """[N] index into head.PARTS."""

    def __len__(self) -> int:
        return len(self.corners)

    def chosen(self, index: NDArray[np.int64] | NDArray[np.bool_]) -> "Rider":
        """A subset, or another order."""
        return Rider(**{name: getattr(self, name)[index] for name in self.__dataclass_fields__})

    def colored(self, color: Floats) -> "Rider":
        """The same splats with other colours [N, 3]."""
        return replace(self, color=color.astype(np.float32))


def joined(riders: list[Rider]) -> Rider:
    """Several sets behind one another."""
    names = Rider.__dataclass_fields__
    return Rider(**{name: np.concatenate([getattr(r, name) for r in riders]) for name in names})


def ride(
    vertices: Floats,
    corners: NDArray[np.int64],
    weights: Floats,
    direction: Floats | None,
    sigma: Floats,
    opacity: Floats,
    color: Floats,
    part: NDArray[np.uint8],
    lift: Floats | float = 0.0,
) -> Rider:
    """Splats at rest on ``vertices``; ``direction`` [N, 3] is what the tangent should follow (None: any)."""
    a, b, c = (vertices[corners[:, k]].astype(float) for k in range(3))
    e1, e2 = b - a, c - a
    normal = np.cross(e1, e2)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
    along = e1 if direction is None else direction
    tangent = along - (along * normal).sum(1, keepdims=True) * normal
    length = np.linalg.norm(tangent, axis=1, keepdims=True)
    tangent = np.where(
        length > 1e-9, tangent / np.maximum(length, 1e-12), e1 / np.linalg.norm(e1, axis=1, keepdims=True)
    )
    bitangent = np.cross(normal, tangent)
    g11, g12, g22 = (e1 * e1).sum(1), (e1 * e2).sum(1), (e2 * e2).sum(1)
    det = np.maximum(g11 * g22 - g12**2, 1e-24)

    def in_edges(v: Floats) -> NDArray[np.float32]:
        p, q = (v * e1).sum(1), (v * e2).sum(1)
        return np.stack([(p * g22 - q * g12) / det, (q * g11 - p * g12) / det], 1).astype(np.float32)

    return Rider(
        corners=corners,
        weights=weights.astype(np.float32),
        tangent=in_edges(tangent),
        bitangent=in_edges(bitangent),
        lift=np.broadcast_to(np.asarray(lift, np.float32), (len(corners),)).copy(),
        sigma=np.asarray(sigma, np.float32),
        opacity=np.asarray(opacity, np.float32),
        color=np.asarray(color, np.float32),
        part=np.asarray(part, np.uint8),
    )


def posed(rider: Rider, vertices: Floats) -> RawGaussians:
    """The splats on one pose of the mesh [V, 3].

    Frames are Gram-Schmidt of the carried tangent and the triangle's normal, so they turn smoothly with the skin;
    scales follow how far the two tangents are stretched.
    """
    count = len(rider)
    positions = np.empty((count, 3), np.float32)
    wxyz = np.empty((count, 4), np.float32)
    stretch = np.ones((count, 3), np.float32)
    _pose(
        np.ascontiguousarray(vertices, np.float32),
        rider.corners,
        rider.weights,
        rider.tangent,
        rider.bitangent,
        rider.lift,
        positions,
        wxyz,
        stretch,
    )
    odds = rider.opacity / (1 - rider.opacity)
    return RawGaussians(positions, wxyz, np.log(rider.sigma * stretch), np.log(odds), rider.color)


@njit(cache=True)
def _pose(vertices, corners, weights, tangent, bitangent, lift, positions, wxyz, stretch):
    for i in range(len(corners)):
        a = vertices[corners[i, 0]].astype(np.float64)
        e1 = vertices[corners[i, 1]] - a
        e2 = vertices[corners[i, 2]] - a
        n = np.cross(e1, e2)
        n /= max(np.sqrt((n * n).sum()), 1e-20)
        t = tangent[i, 0] * e1 + tangent[i, 1] * e2
        length = max(np.sqrt((t * t).sum()), 1e-9)
        x = t / length
        y = np.cross(n, x)
        b = bitangent[i, 0] * e1 + bitangent[i, 1] * e2
        stretch[i, 0] = min(max(length, 0.3), 3.0)
        stretch[i, 1] = min(max(abs((b * y).sum()), 0.3), 3.0)
        for k in range(3):
            positions[i, k] = a[k] + weights[i, 1] * e1[k] + weights[i, 2] * e2[k] + lift[i] * n[k]
        # Shepperd's method on the matrix with columns x, y, n.
        trace = x[0] + y[1] + n[2]
        if trace > 0:
            s = np.sqrt(trace + 1) * 2
            w, qx, qy, qz = 0.25 * s, (y[2] - n[1]) / s, (n[0] - x[2]) / s, (x[1] - y[0]) / s
        elif x[0] > y[1] and x[0] > n[2]:
            s = np.sqrt(1 + x[0] - y[1] - n[2]) * 2
            w, qx, qy, qz = (y[2] - n[1]) / s, 0.25 * s, (y[0] + x[1]) / s, (n[0] + x[2]) / s
        elif y[1] > n[2]:
            s = np.sqrt(1 + y[1] - x[0] - n[2]) * 2
            w, qx, qy, qz = (n[0] - x[2]) / s, (y[0] + x[1]) / s, 0.25 * s, (n[1] + y[2]) / s
        else:
            s = np.sqrt(1 + n[2] - x[0] - y[1]) * 2
            w, qx, qy, qz = (x[1] - y[0]) / s, (n[0] + x[2]) / s, (n[1] + y[2]) / s, 0.25 * s
        sign = 1.0 if w >= 0 else -1.0
        wxyz[i, 0], wxyz[i, 1], wxyz[i, 2], wxyz[i, 3] = sign * w, sign * qx, sign * qy, sign * qz
