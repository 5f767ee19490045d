"""The two sides of a face: where a point of the skin is on the other one, and which skin is around the eyes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...render.arrays import Floats

ACROSS = np.array([-1.0, 1.0, 1.0])
EYE_M, WIDE_M, HIGH_M = (0.031, 0.002), 0.026, 0.022
"""Middle of the skin around an eye, from between the eyes, and how far it reaches; metres on the average head."""


@dataclass(frozen=True)
class Sides:
    """The triangles of a head and their mirror images among them."""

    triangles: NDArray[np.int64]
    """[F, 3] of the head."""
    mirrored: NDArray[np.int64]
    """[F, 3] each corner's vertex on the other side."""
    opposite: NDArray[np.int64]
    """[F] the triangle of these; -1 where there is none."""

    def across(self, faces: NDArray[np.int64], weights: Floats) -> tuple[NDArray[np.int64], Floats]:
        """Triangles [N] and barycentric weights [N, 3] of points on the other side.

        Raises:
            ValueError: a triangle has no mirror image.
        """
        there = self.opposite[faces]
        if (there < 0).any():
            raise ValueError(f"{(there < 0).sum()} of {len(there)} points have no triangle on the other side")
        corner = np.argmax(self.triangles[there][:, :, None] == self.mirrored[faces][:, None, :], axis=2)
        return there, np.take_along_axis(weights, corner, 1)


def sides_of(canvas: Floats, triangles: NDArray[np.int64]) -> Sides:
    """The sides of a head with vertices ``canvas`` [V, 3], nearly its own mirror image, and ``triangles`` [F, 3]."""
    _, vertex = cKDTree(canvas).query(canvas * ACROSS)
    mirrored = vertex[triangles]
    index = {tuple(corners): face for face, corners in enumerate(np.sort(triangles, axis=1).tolist())}
    opposite = np.array([index.get(tuple(corners), -1) for corners in np.sort(mirrored, axis=1).tolist()])
    return Sides(triangles, mirrored, opposite)


def around_eyes(canvas: Floats) -> Floats:
    """[N] in [0, 1]: skin around the eyes, points [N, 3] on the average head; soft at its rim."""
    x, y = EYE_M
    squared = ((np.abs(canvas[:, 0]) - x) / WIDE_M) ** 2 + ((canvas[:, 1] - y) / HIGH_M) ** 2
    return np.minimum(2 * np.exp(-squared), 1) * np.clip((canvas[:, 2] + 0.055) / 0.03, 0, 1)
