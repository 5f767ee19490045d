"""A surface under splats: how it turns and stretches at each vertex as shapes move it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.rotations import matrix_from_wxyz, wxyz_from_matrix
from ..captures.deformation import across

MAX_STRETCH = 2.0
"""A splat grows or shrinks by this factor at most: triangles inside a closed mouth have next to no area."""


@dataclass(frozen=True)
class Surface:
    """Two tangents for each vertex. They are linear in the vertices, and so in the weights of the shapes."""

    tangents: NDArray[np.float32]
    """[2, N, 3] at rest; zeros at vertices without a triangle."""
    changes: NDArray[np.float32]
    """[52, 2, N, 3] what one unit of each weight adds."""

    def chosen(self, which: NDArray[np.integer]) -> "Surface":
        """The surface at some of its vertices."""
        return Surface(self.tangents[:, which], np.ascontiguousarray(self.changes[:, :, which]))


def surface_of(vertices: Floats, triangles: NDArray[np.int64], shapes: Floats) -> Surface:
    """The surface of a mesh [N, 3], [T, 3] moved by ``shapes`` [52, N, 3].

    A vertex has two directions across its normal; each triangle around it says where they go (Sumner and Popovic's
    deformation gradient), and its tangents are the mean of these by area.
    """
    edges = _edges(vertices, triangles)
    normals = np.cross(edges[:, 0], edges[:, 1])
    around = np.zeros(vertices.shape)
    for corner in range(3):
        np.add.at(around, triangles[:, corner], normals)
    length = np.linalg.norm(around, axis=1, keepdims=True)
    first, second = across(np.where(length > 0, around / np.where(length > 0, length, 1), [0, 0, 1]))
    area = np.linalg.norm(normals, axis=1) / 2
    # a direction's coordinates along the two edges, by the pseudoinverse of [edge edge]
    gram = np.einsum("tix,tjx->tij", edges, edges)
    det = gram[:, 0, 0] * gram[:, 1, 1] - gram[:, 0, 1] ** 2
    area = np.where(det > 1e-12 * np.maximum(gram[:, 0, 0] * gram[:, 1, 1], 1e-24), area, 0)
    swapped = np.stack([gram[:, 1, 1], -gram[:, 0, 1], -gram[:, 0, 1], gram[:, 0, 0]], -1).reshape(-1, 2, 2)
    inverse = swapped / np.where(area > 0, det, 1)[:, None, None]
    total = np.bincount(triangles.ravel(), np.repeat(area, 3), len(vertices))
    share = area[:, None] / np.where(total > 0, total, 1)[triangles]
    pulls = []
    for direction in (first, second):
        along = np.einsum("tix,tcx->tci", edges, direction[triangles])
        pulls.append((share[..., None] * np.einsum("tij,tcj->tci", inverse, along)).astype(np.float32))

    def tangents(moved: Floats) -> NDArray[np.float32]:
        sides = _edges(moved, triangles)
        answer = np.empty((2, len(vertices), 3), np.float32)
        for pull, target in zip(pulls, answer, strict=True):
            for axis in range(3):
                values = np.einsum("tci,ti->tc", pull, sides[:, :, axis])
                target[:, axis] = np.bincount(triangles.ravel(), values.ravel(), len(vertices))
        return answer

    changes = np.zeros((len(shapes), 2, len(vertices), 3), np.float32)
    for change, shape in zip(changes, shapes, strict=True):
        if shape.any():
            change[:] = tangents(shape)
    return Surface(tangents(vertices), changes)


def carried(surface: Surface, weights: Floats, wxyz: Floats, log_scales: Floats) -> tuple[Floats, Floats]:
    """Rotations [N, 4] and log scales [N, 3] of splats that the surface takes along.

    Args:
        surface: of N vertices.
        weights: [52] of the shapes.
        wxyz: [N, 4] rotations at rest.
        log_scales: [N, 3] at rest.
    """
    moved = surface.tangents + np.tensordot(weights, surface.changes, 1)
    before = _frames(surface.tangents, np.eye(3))
    after = _frames(moved, before)
    axes = matrix_from_wxyz(wxyz)
    turned = after @ (before.swapaxes(1, 2) @ axes)
    lengths = [
        np.linalg.norm(_mapped(t, f, before, axes), axis=1) for t, f in ((surface.tangents, before), (moved, after))
    ]
    stretch = np.log(np.maximum(lengths[1], 1e-6)) - np.log(np.maximum(lengths[0], 1e-6))
    limit = np.log(MAX_STRETCH)
    return (
        wxyz_from_matrix(turned).astype(np.float32),
        (log_scales + np.clip(stretch, -limit, limit)).astype(np.float32),
    )


def _mapped(tangents: Floats, frames: Floats, before: Floats, axes: Floats) -> Floats:
    """[N, 3, 3] where a splat's axes (columns) go when the rest frame's tangents go to ``tangents``, its normal to
    that of ``frames``."""
    along = before.swapaxes(1, 2) @ axes
    to = np.stack([tangents[0], tangents[1], frames[:, :, 2]], -1)
    return to @ along


def _frames(tangents: Floats, otherwise: Floats) -> Floats:
    """[N, 3, 3] columns first tangent, second, normal, by Gram-Schmidt; ``otherwise`` where they span no plane."""
    first, second = np.asarray(tangents, np.float64)
    normal = np.cross(first, second)
    size, length = np.linalg.norm(normal, axis=1), np.linalg.norm(first, axis=1)
    flat = (size < 1e-9) | (length < 1e-9)
    normal /= np.where(flat, 1, size)[:, None]
    first = first / np.where(flat, 1, length)[:, None]
    frames = np.stack([first, np.cross(normal, first), normal], -1)
    return np.where(flat[:, None, None], otherwise, frames)


def _edges(vertices: Floats, triangles: NDArray[np.int64]) -> Floats:
    """[T, 2, 3]."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return np.stack([b - a, c - a], 1).astype(np.float64)
