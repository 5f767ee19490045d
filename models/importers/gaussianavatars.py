"""GaussianAvatars: splats that ride on the triangles of a mesh (Qian et al., CVPR 2024), with the mesh frame by frame.

``point_cloud.ply`` has the 3DGS layout and one property more, ``binding_0``: the triangle each splat belongs to. Its
position, rotation and scale are those in the frame of that triangle: origin in the middle, axes along the first edge,
the normal, and across both, and for unit the mean of base and height. The tracked meshes are asked for as files:
FLAME, whose parameters such avatars are published with, may not be passed on.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.gaussians import RawGaussians
from ...render.rotations import matrix_from_wxyz, wxyz_from_matrix
from .foreign import ForeignFormatError
from .meshes import MeshSequence, open_meshes
from .placing import canonical_shift, scaled
from .plysource import ply_source
from .source import Source
from .splatply import LOG_SCALE_LIMITS, column_of, read_splats
from .stillness import held_still

BINDING = "binding_0"
SPLATS, MESHES = "point_cloud.ply", "meshes"
"""What the file is called, and the folder beside it in which the meshes are looked for."""
_FLAT = 1e-9
"""Metres; a triangle with a shorter side or height has no frame of its own."""


@dataclass(frozen=True)
class TriangleFrames:
    """Where the triangles of a mesh are, and how turned and large."""

    centers: Floats
    """[T, 3]"""
    axes: Floats
    """[T, 3, 3] columns: along the first edge, the normal, across both."""
    sizes: Floats
    """[T] mean of the first edge's length and the height over it."""


def is_bound(path: Path) -> bool:
    """Whether a PLY of splats says which triangles they ride on. Raises ForeignFormatError for no PLY of splats."""
    return column_of(path, BINDING) is not None


def open_bound(path: Path, meshes: Path | None = None, scale: float = 1.0) -> Source:
    """An avatar of GaussianAvatars.

    Args:
        path: ``point_cloud.ply``.
        meshes: where the mesh is frame by frame, as for ``open_meshes``; None looks beside the file.
        scale: metres of one of the files' units; y is up in them, and the face looks along +z.

    Raises:
        ForeignFormatError: for anything else; for later frames, from ``frames``.
    """
    sequence = open_meshes(_beside(path) if meshes is None else meshes)
    local, binding = read_splats(path), _binding(path, sequence)
    first = triangle_frames(sequence.vertices(0), sequence.triangles, None)
    unplaced = scaled(carried(local, binding, first), scale)
    shift = canonical_shift(unplaced, path)
    rest = replace(unplaced, positions=unplaced.positions + shift)

    def frames() -> Iterator[RawGaussians]:
        for index in range(sequence.count):
            moved = triangle_frames(sequence.vertices(index), sequence.triangles, first)
            yield held_still(scaled(carried(local, binding, moved), scale), rest)

    return ply_source(path, "GaussianAvatars PLY", "its first mesh", rest, sequence.count, frames)


def triangle_frames(
    vertices: Floats, triangles: NDArray[np.integer], otherwise: TriangleFrames | None
) -> TriangleFrames:
    """The frames of triangles [T, 3] of vertices [V, 3]; those without an area keep axes and size of ``otherwise``."""
    a, b, c = (vertices[triangles[:, corner]].astype(np.float64) for corner in range(3))
    base = np.linalg.norm(b - a, axis=1)
    along = (b - a) / np.maximum(base, _FLAT)[:, None]
    normal = np.cross(along, c - a)
    height = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(height, _FLAT)[:, None]
    axes = np.stack([along, normal, np.cross(along, normal)], -1)
    sizes = (base + height) / 2
    flat = (base < _FLAT) | (height < _FLAT)
    axes[flat] = np.eye(3) if otherwise is None else otherwise.axes[flat]
    sizes[flat] = _FLAT if otherwise is None else otherwise.sizes[flat]
    return TriangleFrames((a + b + c) / 3, axes, sizes)


def carried(local: RawGaussians, binding: NDArray[np.integer], frames: TriangleFrames) -> RawGaussians:
    """Splats [N] out of the frames of the triangles ``binding`` [N] into the mesh's space."""
    axes, sizes = frames.axes[binding], frames.sizes[binding]
    positions = np.einsum("nij,nj->ni", axes, local.positions) * sizes[:, None] + frames.centers[binding]
    wxyz = wxyz_from_matrix(axes @ matrix_from_wxyz(local.wxyz.astype(np.float64)))
    log_scales = np.clip(local.log_scales + np.log(sizes)[:, None], *LOG_SCALE_LIMITS)
    values = (positions, wxyz, log_scales, local.opacity_logits, local.colors)
    return RawGaussians(*(np.ascontiguousarray(value, np.float32) for value in values))


def _beside(path: Path) -> Path:
    place = path.parent / MESHES
    if not place.exists():
        what = f"its splats ride on a mesh, and there is no folder '{MESHES}' beside it"
        raise ForeignFormatError(path, what, "give --meshes: the tracked vertices and triangles, frame by frame")
    return place


def _binding(path: Path, sequence: MeshSequence) -> NDArray[np.int64]:
    """[N] the triangle of each splat."""
    values = column_of(path, BINDING)
    if values is None:
        raise ForeignFormatError(
            path, f"it has no {BINDING}: its splats ride on no mesh", "distill it without --meshes"
        )
    count = len(sequence.triangles)
    if not np.isfinite(values).all() or (values < 0).any() or (values >= count).any() or (values % 1 != 0).any():
        what = f"its {BINDING} are not all among the {count} triangles of {sequence.place}"
        raise ForeignFormatError(path, what, "give the meshes of this avatar")
    return values.astype(np.int64)
