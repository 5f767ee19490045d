"""How the neighbourhood of each vertex turns and stretches as a mesh moves: deformation gradients."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

MAX_STRETCH = 2.0
"""A surface grows or shrinks by this factor at most: triangles between closed lips or lids have next to no area."""
_FLAT = 1e-10
"""Square metres; a triangle with less has no direction."""


@dataclass(frozen=True)
class RestMesh:
    """A mesh at rest, against which its moved vertices are measured (Sumner and Popovic 2004).

    Their gradients are constant on each triangle and jump at its edges; here a vertex has the mean of those around it
    by area, so that splats between vertices do not break apart along edges.
    """

    vertices: NDArray[np.float64]
    """[V, 3] metres."""
    triangles: NDArray[np.int64]
    """[T, 3]."""

    @cached_property
    def normals(self) -> NDArray[np.float64]:
        """[V, 3] unit normals by area; +z where a vertex has no triangle."""
        return vertex_normals(self.vertices, self.triangles)

    def gradients(self, moved: Floats) -> NDArray[np.float64]:
        """[V, 3, 3] what a small step on the mesh at rest becomes on ``moved`` [V, 3]; the identity at vertices
        without a sound triangle."""
        sides = _framed(np.asarray(moved, np.float64), self.triangles)
        weighted = self._weights[:, None, None] * (sides @ self._inverses)
        total = np.empty((len(self.vertices), 9))
        corners = self.triangles.ravel()
        for entry, values in enumerate(weighted.reshape(-1, 9).T):
            total[:, entry] = np.bincount(corners, np.repeat(values, 3), len(total))
        sound = self._shares > 0
        mean = total.reshape(-1, 3, 3) / np.where(sound, self._shares, 1)[:, None, None]
        return np.where(sound[:, None, None], mean, np.eye(3))

    @cached_property
    def _weights(self) -> NDArray[np.float64]:
        areas = _areas(self.vertices, self.triangles)
        return np.where(areas > _FLAT, areas, 0)

    @cached_property
    def _inverses(self) -> NDArray[np.float64]:
        framed = _framed(self.vertices, self.triangles)
        return np.linalg.inv(np.where(self._weights[:, None, None] > 0, framed, np.eye(3)))

    @cached_property
    def _shares(self) -> Floats:
        return np.asarray(
            np.bincount(self.triangles.ravel(), np.repeat(self._weights, 3), len(self.vertices)), np.float64
        )


def guarded(gradients: Floats, frames: Floats) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gradients [N, 3, 3] that no splat is torn by, and the rotations [N, 3, 3] in them.

    The rotation takes the rest frame's first direction and its plane along (Gram-Schmidt: the axes of an SVD would
    jump where two stretches are alike). Stretches stay within MAX_STRETCH; what is sound comes back as it was.

    Args:
        gradients: of ``RestMesh.gradients``, or means of such.
        frames: [N, 3, 3] rest frames, columns tangent, second tangent, normal.
    """
    carried = gradients @ frames
    turned = orthonormal(carried[..., 0], carried[..., 1], frames)
    stretch = turned.swapaxes(-1, -2) @ carried
    diagonal = np.arange(3)
    lengths = np.clip(stretch[..., diagonal, diagonal], 1 / MAX_STRETCH, MAX_STRETCH)
    stretch = np.clip(stretch, -MAX_STRETCH, MAX_STRETCH)
    stretch[..., diagonal, diagonal] = lengths
    back = frames.swapaxes(-1, -2)
    return turned @ stretch @ back, turned @ back


def orthonormal(first: Floats, second: Floats, otherwise: Floats) -> NDArray[np.float64]:
    """[N, 3, 3] columns: along ``first`` [N, 3], across it in the plane of ``second`` [N, 3], their normal.

    ``otherwise`` [N, 3, 3] stands where the two span no plane.
    """
    normal = np.cross(first, second)
    size, length = np.linalg.norm(normal, axis=-1), np.linalg.norm(first, axis=-1)
    flat = (size < 1e-6 * length) | (length < 1e-12) | (size < 1e-12)
    normal = normal / np.where(flat, 1, size)[..., None]
    along = first / np.where(flat, 1, length)[..., None]
    frames = np.stack([along, np.cross(normal, along), normal], -1)
    return np.where(flat[..., None, None], otherwise, frames)


def across(normals: Floats) -> tuple[Floats, Floats]:
    """Two unit directions across each unit normal [N, 3], square to each other."""
    helper = np.where(np.abs(normals[:, :1]) < 0.7, [[1.0, 0, 0]], [[0, 1.0, 0]])
    first = np.cross(helper, normals)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normals, first)


def vertex_normals(vertices: Floats, triangles: NDArray[np.integer]) -> NDArray[np.float64]:
    """[V, 3] unit normals of a mesh by area; +z where a vertex has no triangle."""
    a, b, c = (np.asarray(vertices, np.float64)[triangles[:, corner]] for corner in range(3))
    facing = np.cross(b - a, c - a)
    total = np.stack([np.bincount(triangles.ravel(), np.repeat(side, 3), len(vertices)) for side in facing.T], -1)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 1e-15, total / np.maximum(length, 1e-15), [0, 0, 1.0])


def _framed(vertices: Floats, triangles: NDArray[np.integer]) -> NDArray[np.float64]:
    """[T, 3, 3] columns: two sides and the normal, whose length is the root of twice the area (their equation 2)."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    facing = np.cross(b - a, c - a)
    size = np.sqrt(np.linalg.norm(facing, axis=1, keepdims=True))
    return np.stack([b - a, c - a, facing / np.maximum(size, 1e-9)], -1)


def _areas(vertices: Floats, triangles: NDArray[np.integer]) -> NDArray[np.float64]:
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
