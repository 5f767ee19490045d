"""What an expression darkens: skin that turns from the light or is hidden from it, and lines that fold."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from ...render.arrays import Floats, Floats32, Indices
from .creases import creases
from .head import Head
from .light import irradiance, part_of_vertex
from .shading import nearness
from .skinflow import Neighbours, folded, neighbours_of, spread
from .soup import SKIN

LINE_DARKENS = 0.26, 0.42
"""Share of the light that the deepest line takes from skin without wrinkles, and from wrinkled skin."""
DROWNED = 0.4
"""Share of the light: where shadows take so much, no line is seen in them."""
BLUR_M = 2.6e-3
"""How far shadows run under the skin, metres."""
RAYS_ACROSS = 7
FOREHEAD_M = 0.030
"""Metres above the eyes, on the canvas."""
FOREHEAD_SPREAD_M, FOREHEAD_ROUNDS, FOREHEAD_GAIN = 0.008, 6, 2.2
"""How far folds spread there, so often, and by what they are more then."""


@dataclass(frozen=True)
class Darkening:
    """How dark points of a head's skin become."""

    head: Head
    wrinkles: float
    """The person's, in [0, 1]."""
    skin: Indices
    """[M] the vertices that matter, of skin."""

    def lost(self, vertices: Floats, corners: Indices, weights: Floats) -> tuple[Floats, Floats]:
        """Of the light on points at rest, given by the vertices [N, 3] of their triangles and ``weights`` [N, 3], the
        share that a pose [V, 3] of the head takes: in shadows [N], and in lines [N] that fold there."""
        shadow = np.zeros(len(vertices))
        shadow[self.skin] = self._blur @ (1 - self._light(vertices) / self._rest)
        fold = self._folded(vertices)
        in_shadow, in_fold = (np.clip((values[corners] * weights).sum(1), 0, 1) for values in (shadow, fold))
        canvas = (self.head.canvas[corners] * weights[..., None]).sum(1)
        deepest = np.interp(self.wrinkles, (0, 1), LINE_DARKENS)
        lines = deepest * in_fold * creases(canvas, 0) * np.clip(1 - in_shadow / DROWNED, 0, 1)
        return in_shadow, lines

    def _folded(self, vertices: Floats) -> Floats32:
        """How much [V] in 0..1 skin is pushed together; on the forehead a wide band is by what MakeHuman's raised
        brows push together in a narrow one."""
        fold = folded(self.head.vertices, vertices, self._triangles, self._neighbours)
        wide = fold[:, None]
        for _ in range(FOREHEAD_ROUNDS):
            wide = spread(wide, self._neighbours, (FOREHEAD_SPREAD_M,))
        return np.where(self.head.canvas[:, 1] > FOREHEAD_M, np.clip(FOREHEAD_GAIN * wide[:, 0], 0, 1), fold)

    @cached_property
    def _triangles(self) -> Indices:
        """Those of the skin at which one of its vertices lies."""
        skin = self.head.triangles[self.head.parts == SKIN]
        return skin[np.isin(skin, self.skin).any(1)]

    @cached_property
    def _neighbours(self) -> Neighbours:
        return neighbours_of(self.head.vertices, self._triangles)

    @cached_property
    def _blur(self) -> sparse.csr_matrix:
        return nearness(self.head.vertices[self.skin], BLUR_M)

    @cached_property
    def _rest(self) -> Floats:
        return self._light(self.head.vertices)

    def _light(self, vertices: Floats) -> Floats:
        """[M] mean of the colours, hair aside."""
        hair = np.zeros(len(self.head.triangles), bool)
        return irradiance(self.head, vertices, hair, self.skin, RAYS_ACROSS).mean(1)


def skin_of_face(head: Head) -> Indices:
    """[M] the vertices of the skin above the throat, and as far back as the ears."""
    there = (head.canvas[:, 1] > -0.13) & (head.canvas[:, 2] > -0.09)
    return np.flatnonzero((part_of_vertex(head) == SKIN) & there)
