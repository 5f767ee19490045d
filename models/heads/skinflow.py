"""What happens along the skin from vertex to vertex: light spreading underneath, and folds where it is compressed."""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

SPREAD_M = (0.0040, 0.0018, 0.0011)
"""How far red, green and blue travel under the skin."""
ROUNDS = 10
LEAST_FOLD, FULL_FOLD = 0.05, 0.24
"""Compression at which lines begin to show, and at which they are deepest."""


@dataclass(frozen=True)
class Neighbours:
    """Which vertices are joined by an edge, row by row."""

    first: NDArray[np.int64]
    """[V + 1] where each vertex's neighbours begin in ``others``."""
    others: NDArray[np.int64]
    spacing: NDArray[np.float32]
    """[V] mean length of the edges, metres; a large number for vertices without."""


def neighbours_of(vertices: Floats, triangles: NDArray[np.integer]) -> Neighbours:
    """Neighbours in the mesh [V, 3], [T, 3]."""
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    pairs = np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)
    lengths = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
    count = np.bincount(pairs[:, 0], minlength=len(vertices))
    total = np.bincount(pairs[:, 0], lengths, minlength=len(vertices))
    spacing = np.where(count > 0, total / np.maximum(count, 1), 1.0).astype(np.float32)
    return Neighbours(np.concatenate([[0], np.cumsum(count)]), np.ascontiguousarray(pairs[:, 1]), spacing)


def spread(values: Floats, neighbours: Neighbours, distances: tuple[float, ...]) -> NDArray[np.float32]:
    """Values [V, C] spread over the mesh, channel by channel as far as ``distances`` [C] metres say."""
    # a round that moves a share s to the neighbours at distance h spreads by h sqrt(s / 2) along each axis
    share = 2 * np.square(distances)[None] / (ROUNDS * np.square(neighbours.spacing)[:, None])
    share = np.minimum(share, 0.85).astype(np.float32)
    values = np.ascontiguousarray(values, np.float32)
    for _ in range(ROUNDS):
        values = _passed_on(values, share, neighbours.first, neighbours.others)
    return values


@numba.njit(cache=True, parallel=True)
def _passed_on(values, share, first, others):
    answer = values.copy()
    for v in numba.prange(len(values)):
        count = first[v + 1] - first[v]
        if count == 0:
            continue
        for k in range(values.shape[1]):
            total = np.float32(0)
            for i in range(first[v], first[v + 1]):
                total += values[others[i], k]
            answer[v, k] += share[v, k] * (total / count - values[v, k])
    return answer


def folded(rest: Floats, posed: Floats, triangles: NDArray[np.integer], neighbours: Neighbours) -> NDArray[np.float32]:
    """How much [V] in 0..1 the skin is compressed along the direction in which it is most."""
    least = least_stretch(rest, posed, triangles)
    total = np.zeros(len(rest))
    count = np.zeros(len(rest))
    for corner in range(3):
        total += np.bincount(triangles[:, corner], least, minlength=len(rest))
        count += np.bincount(triangles[:, corner], minlength=len(rest))
    mean = np.where(count > 0, total / np.maximum(count, 1), 1)
    smooth = spread(mean[:, None], neighbours, (0.003,))[:, 0]
    return np.clip((1 - smooth - LEAST_FOLD) / (FULL_FOLD - LEAST_FOLD), 0, 1).astype(np.float32)


def least_stretch(rest: Floats, posed: Floats, triangles: NDArray[np.integer]) -> Floats:
    """The smaller singular value [T] of what takes each triangle from rest to the pose; 1 leaves it as it is."""
    metric = []
    for vertices in (rest, posed):
        a, b, c = (vertices[triangles[:, corner]].astype(np.float64) for corner in range(3))
        e, f = b - a, c - a
        metric.append(np.stack([(e * e).sum(1), (e * f).sum(1), (f * f).sum(1)], 1))
    (a, b, c), (p, q, r) = metric[0].T, metric[1].T
    det = np.maximum(a * c - b * b, 1e-22)
    # eigenvalues of inverse(rest metric) @ posed metric are the squared stretches
    trace = (c * p - 2 * b * q + a * r) / det
    product = (p * r - q * q) / det
    root = np.sqrt(np.maximum(trace * trace / 4 - product, 0))
    return np.sqrt(np.maximum(trace / 2 - root, 0))
