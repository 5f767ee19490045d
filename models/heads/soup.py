"""Surfaces joined to one triangle soup."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

PARTS = ("skin", "eyes", "teeth", "tongue", "lashes", "hair", "glints", "veil")
SKIN, EYES, TEETH, TONGUE, LASHES, HAIR, GLINTS, VEIL = range(8)


@dataclass(frozen=True)
class Surface:
    """One part of a head, decimetres."""

    part: int
    """Index into PARTS."""
    vertices: Floats
    """[P, 3]"""
    deltas: Floats
    """[52, P, 3] what one unit of each ARKit weight adds."""
    average: Floats
    """[P, 3] the vertices on the average MakeHuman head."""
    triangles: NDArray[np.int64]
    """[F, 3]"""
    texture: Floats
    """[F, 3, 2] u, v of the corners in the part's own map."""


@dataclass(frozen=True)
class Soup:
    """All surfaces, one behind the other, decimetres."""

    vertices: Floats
    """[V, 3]"""
    deltas: Floats
    """[52, V, 3]"""
    average: Floats
    """[V, 3]"""
    triangles: NDArray[np.int64]
    """[F, 3]"""
    texture: Floats
    """[F, 3, 2]"""
    parts: NDArray[np.uint8]
    """[F] index into PARTS."""
    part_of_vertex: NDArray[np.uint8]
    """[V] index into PARTS."""

    def marked(self, part: int, marks: NDArray[np.int8]) -> NDArray[np.int8]:
        """[V] the ``marks`` of the vertices of one part, -1 for all others."""
        every = np.full(len(self.vertices), -1, np.int8)
        every[self.part_of_vertex == part] = marks
        return every


def joined(surfaces: Sequence[Surface]) -> Soup:
    """One soup of surfaces of different parts."""
    counts = [len(surface.vertices) for surface in surfaces]
    starts = np.cumsum([0, *counts[:-1]])
    parts = np.array([surface.part for surface in surfaces], np.uint8)
    return Soup(
        vertices=np.concatenate([surface.vertices for surface in surfaces]),
        deltas=np.concatenate([surface.deltas for surface in surfaces], 1),
        average=np.concatenate([surface.average for surface in surfaces]),
        triangles=np.concatenate([s.triangles + start for s, start in zip(surfaces, starts, strict=True)]),
        texture=np.concatenate([surface.texture for surface in surfaces]),
        parts=np.repeat(parts, [len(surface.triangles) for surface in surfaces]),
        part_of_vertex=np.repeat(parts, counts),
    )
