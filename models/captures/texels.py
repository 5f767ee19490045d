"""One splat for each texel that a template covers in its UV map, and how a moved mesh takes them along."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.gaussians import RawGaussians
from ...render.rotations import matrix_from_wxyz, sign_aligned, wxyz_from_matrix
from .deformation import RestMesh, across, guarded, orthonormal
from .uvraster import cover

FOOTPRINT = 0.6
"""Standard deviation of a splat along the surface in distances between texels: less leaves holes, more blurs."""
THICKNESS = 0.12
"""... and across it, as a share of that along it."""
OPACITY = 0.95
"""Peak opacity of a splat that nothing has been learned of: such a logit still has a slope."""
SMALLEST_M, LARGEST_M = 1e-4, 1e-2
"""Bounds of that standard deviation, metres: a UV map may squeeze a triangle or pull it apart."""
LONGEST = 2.0
"""A splat is at most so many times as long as it is wide: needles stick out where the surface bends."""


class Mesh(Protocol):
    """What texels need to know of a template (``models.captures.layout.Template``)."""

    @property
    def vertices(self) -> NDArray[np.floating]:
        """[V, 3] canonical neutral, metres."""
        ...

    @property
    def triangles(self) -> NDArray[np.integer]:
        """[T, 3]."""
        ...

    @property
    def uv(self) -> NDArray[np.floating]:
        """[C, 2] in [0, 1], v upwards."""
        ...

    @property
    def uv_triangles(self) -> NDArray[np.integer]:
        """[T, 3]."""
        ...

    @property
    def parts(self) -> NDArray[np.integer]:
        """[T]."""
        ...


@dataclass(frozen=True)
class Texels:
    """N covered texels of a template, row by row."""

    template: Mesh
    size: int
    """Texels along a side of the map."""
    triangle: NDArray[np.int64]
    """[N] under the middle of each."""
    barycentric: NDArray[np.float64]
    """[N, 3] there."""
    uv_index: NDArray[np.int64]
    """[N] row * size + column; the first row is the uppermost."""
    part: NDArray[np.int64]
    """[N] the part of the template."""

    def __len__(self) -> int:
        return len(self.triangle)

    def spread(self, values: Floats) -> NDArray[np.float64]:
        """Values [V, ...] of vertices at the texels [N, ...]."""
        return np.einsum("nc,nc...->n...", self.barycentric, np.asarray(values, np.float64)[self._corners])

    def splats(self, colors: Floats) -> RawGaussians:
        """The canonical splats: flat, along the surface, so large that they close it. ``colors`` [N, 3] RGB in [0, 1].

        Their first axis is that of growing u.
        """
        return RawGaussians(
            self.spread(self.template.vertices).astype(np.float32),
            self._wxyz.astype(np.float32),
            np.log(self._sigmas).astype(np.float32),
            np.full(len(self), np.log(OPACITY / (1 - OPACITY)), np.float32),
            np.ascontiguousarray(colors, np.float32),
        )

    def carried(self, raw: RawGaussians, vertices: Floats) -> RawGaussians:
        """Canonical splats [N] taken along by moved vertices [V, 3]: the bare mesh's avatar.

        Means and covariances go through the deformation gradient; a covariance keeps its axes, turned, and their new
        lengths. Quaternions keep the sign of the canonical ones, so that a PCA sees no jumps.
        """
        gradients, turns = self.moved(vertices)
        offsets = raw.positions - self.spread(self.template.vertices)
        axes = matrix_from_wxyz(raw.wxyz.astype(np.float64))
        lengths = np.linalg.norm(gradients @ axes, axis=1)
        return RawGaussians(
            (self.spread(vertices) + np.einsum("nij,nj->ni", gradients, offsets)).astype(np.float32),
            sign_aligned(wxyz_from_matrix(turns @ axes), raw.wxyz).astype(np.float32),
            (raw.log_scales + np.log(np.maximum(lengths, 1e-6))).astype(np.float32),
            raw.opacity_logits,
            raw.colors,
        )

    def moved(self, vertices: Floats) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """[N, 3, 3] deformation gradients for moved vertices [V, 3], and the rotations [N, 3, 3] in them."""
        return guarded(self.spread(self._rest.gradients(vertices)), self.frames)

    @cached_property
    def frames(self) -> NDArray[np.float64]:
        """[N, 3, 3] at rest; columns along growing u, across it, outwards."""
        normals = self.spread(self._rest.normals)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        fallback = np.stack([*across(normals), normals], -1)
        along = self._steps[0] - (self._steps[0] * normals).sum(1, keepdims=True) * normals
        return orthonormal(along, np.cross(normals, along), fallback)

    @cached_property
    def _rest(self) -> RestMesh:
        return RestMesh(np.asarray(self.template.vertices, np.float64), np.asarray(self.template.triangles, np.int64))

    @cached_property
    def _corners(self) -> NDArray[np.int64]:
        return np.asarray(self.template.triangles, np.int64)[self.triangle]

    @cached_property
    def _wxyz(self) -> Floats:
        return wxyz_from_matrix(self.frames)

    @cached_property
    def _sigmas(self) -> NDArray[np.float64]:
        """[N, 3] metres: the texel's footprint on the surface."""
        along, up = self._steps
        first = np.abs((along * self.frames[..., 0]).sum(1))
        # the part of v's step that lies across u's: a slanted texel is as wide as its area says
        second = np.abs((up * self.frames[..., 1]).sum(1))
        sides = np.clip(FOOTPRINT * np.stack([first, second], 1), SMALLEST_M, LARGEST_M)
        sides = np.minimum(sides, LONGEST * sides[:, ::-1])
        return np.concatenate([sides, THICKNESS * np.sqrt(sides.prod(1, keepdims=True))], 1)

    @cached_property
    def _steps(self) -> NDArray[np.float64]:
        """[2, N, 3] metres on the surface of one texel to the right and of one up, smooth across triangles."""
        vertices = np.asarray(self.template.vertices, np.float64)
        corners, seams = (np.asarray(x, np.int64) for x in (self.template.triangles, self.template.uv_triangles))
        sides = np.stack([vertices[corners[:, i]] - vertices[corners[:, 0]] for i in (1, 2)], -1)
        uv = np.asarray(self.template.uv, np.float64)
        flat = np.stack([uv[seams[:, i]] - uv[seams[:, 0]] for i in (1, 2)], -1)
        areas = np.abs(np.linalg.det(flat))
        sound = areas > 1e-12
        inverses = np.linalg.inv(np.where(sound[:, None, None], flat, np.eye(2)))
        weighted = np.where(sound, areas, 0)[:, None, None] * (sides @ inverses) / self.size
        # by corner of the atlas, not by vertex: at its seams u and v begin anew
        total = np.stack([np.bincount(seams.ravel(), np.repeat(x, 3), len(uv)) for x in weighted.reshape(-1, 6).T], -1)
        shares = np.bincount(seams.ravel(), np.repeat(np.where(sound, areas, 0), 3), len(uv))
        mean = (total / np.maximum(shares, 1e-15)[:, None]).reshape(-1, 3, 2)
        here = np.einsum("nc,ncij->nij", self.barycentric, mean[seams[self.triangle]])
        return np.moveaxis(here, -1, 0)


def texels_of(template: Mesh, size: int) -> Texels:
    """Every texel of a ``size`` x ``size`` map whose middle the template covers.

    Raises ValueError where the template covers none.
    """
    owners, places = cover(template.uv, template.uv_triangles, size)
    index = np.flatnonzero(owners.ravel() >= 0)
    if not len(index):
        raise ValueError(f"the template covers no texel of a {size} x {size} map; are its uv within [0, 1]?")
    triangle = owners.ravel()[index].astype(np.int64)
    barycentric = places.reshape(-1, 3)[index].astype(np.float64)
    barycentric /= barycentric.sum(1, keepdims=True)
    return Texels(template, size, triangle, barycentric, index, np.asarray(template.parts, np.int64)[triangle])
