"""LAM avatars: ``skin.glb``, a mesh with ARKit shapes, and ``offset.ply``, one splat for each of its vertices.

Splat i rides on vertex i: its centre is the vertex, moved by the shapes, plus an offset that never changes. The source
keeps rotations and scales constant; here they follow the surface under the splat, so that lids and lips which turn
take their splats with them. Frames hold the expression only: the skeleton, and with it the head's motion, stays out.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.gaussians import RawGaussians
from ...render.projection import ALPHA_MIN
from ..arkit import NAMES
from ..gem import Viewing
from .floaters import neighbours
from .foreign import ForeignFormatError
from .glb import FLOAT, INDEX, Glb, read_glb
from .meshes import MAX_TRIANGLES
from .neck import CHIN, PIVOT, bending
from .source import Source
from .splatply import MAX_COORDINATE, read_splats
from .surface import Surface, carried, surface_of

MESH, SPLATS = "skin.glb", "offset.ply"
MAX_VERTICES = 200_000
"""LAM heads have 20,018."""
NECK_SHARE = 0.30
"""The height of the neck's joint as a part of the mesh's, which reaches from the collar to the crown."""
NECK_DEPTH = -0.0224
"""Where that joint lies in depth, metres in the file's own space."""
BEHIND = -0.04
"""Depth behind the ears, metres, canonical space; splats of the head there were never seen, and those that hang in the
air are left out: a dozen or two, which show as dark blobs from 15 degrees on and change the front by 41 dB or more."""
COMPANY = 4
"""Fewer splats than this within a centimetre or two are in the air."""
YAW_LIMIT_DEG, PITCH_LIMIT_DEG = 25.0, 15.0
"""Nothing was ever reconstructed behind."""


@dataclass(frozen=True)
class LamAvatar:
    """A head that ARKit weights pose; canonical space."""

    rest: RawGaussians
    """[N] at rest."""
    surface: Surface
    """What carries the splats."""
    shapes: NDArray[np.float32]
    """[52, N, 3] what one unit of each ARKit weight adds to the centres, metres; zeros where the file has no shape."""
    names: tuple[str, ...]
    """The ARKit shapes that the file has."""
    floaters: int = 0
    """How many splats were left out because they hang in the air behind the head."""

    def __len__(self) -> int:
        return len(self.rest)

    def frame(self, weights: Floats) -> RawGaussians:
        """The splats of one expression, ARKit ``weights`` [52]."""
        weights = np.asarray(weights, np.float32)
        moved = np.tensordot(weights, self.shapes, 1)
        wxyz, log_scales = carried(self.surface, weights, self.rest.wxyz, self.rest.log_scales)
        positions = (self.rest.positions + moved).astype(np.float32)
        return RawGaussians(positions, wxyz, log_scales, self.rest.opacity_logits, self.rest.colors)

    def source(self, performance: NDArray[np.float32]) -> Source:
        """The avatar acting a performance [F, 52]."""

        def frames() -> Iterator[RawGaussians]:
            return (self.frame(weights) for weights in performance)

        missing = [name for name in NAMES if name not in self.names]
        notes = [f"it has no {', '.join(missing)}"] if missing else []
        if self.floaters:
            notes.append(f"{self.floaters} splats that hang in the air behind the head were left out")
        return Source(
            kind="LAM avatar",
            splats=len(self),
            count=len(performance),
            frames=frames,
            rest=self.rest,
            neck_weights=bending(self.rest.positions),
            neck_pivot=PIVOT,
            viewing=_viewing(self.rest),
            performance=performance,
            notes=tuple(notes),
        )


def load_lam(folder: Path) -> LamAvatar:
    """Reads the folder that holds ``skin.glb`` and ``offset.ply``.

    Splats too faint for any picture are left out, and those that hang in the air behind the head.

    Raises ForeignFormatError.
    """
    mesh, splats = read_glb(folder / MESH), read_splats(folder / SPLATS, plain_colours=True)
    primitive = _primitive(mesh)
    vertices = mesh.array(primitive["attributes"].get("POSITION"), "vertices", "VEC3", FLOAT, most=MAX_VERTICES)
    count = len(vertices)
    if len(splats) != count:
        raise ForeignFormatError(
            folder, f"{SPLATS} has {len(splats)} splats for {count} vertices", "take both files from one avatar"
        )
    triangles = mesh.array(primitive.get("indices"), "corners of triangles", "SCALAR", INDEX, most=3 * MAX_TRIANGLES)
    if len(triangles) % 3 or (triangles >= count).any():
        raise mesh.wrong("its triangles point beyond its vertices, or one is not whole")
    names, shapes = _shapes(mesh, primitive, count)
    if max(np.abs(vertices).max(), np.abs(shapes).max()) > MAX_COORDINATE:
        raise mesh.wrong(f"its vertices, or their shapes, reach farther than {MAX_COORDINATE:g}")
    surface = surface_of(vertices, triangles.reshape(-1, 3).astype(np.int64), shapes)
    height = vertices[:, 1].min() + NECK_SHARE * np.ptp(vertices[:, 1])
    shift = PIVOT - np.array([0, height, NECK_DEPTH], np.float32)
    centres = (vertices + splats.positions + shift).astype(np.float32)
    seen = np.flatnonzero(1 / (1 + np.exp(-splats.opacity_logits)) > ALPHA_MIN)
    if not len(seen):
        raise ForeignFormatError(folder / SPLATS, "none of its splats can be seen", "take both files from one avatar")
    air = (centres[seen, 2] < BEHIND) & (bending(centres[seen]) > 0.5) & (neighbours(centres[seen]) < COMPANY)
    seen = seen[~air]
    rest = RawGaussians(
        centres[seen],
        splats.wxyz[seen],
        splats.log_scales[seen],
        splats.opacity_logits[seen],
        splats.colors[seen],
    )
    return LamAvatar(rest, surface.chosen(seen), np.ascontiguousarray(shapes[:, seen]), names, int(air.sum()))


def _primitive(mesh: Glb) -> dict:
    """The one mesh's one primitive."""
    meshes = mesh.tree.get("meshes")
    primitives = mesh.item("meshes", 0).get("primitives") if isinstance(meshes, list) else None
    if not isinstance(primitives, list) or len(primitives) != 1 or not isinstance(primitives[0], dict):
        raise mesh.wrong("its first mesh is not of one primitive")
    primitive = primitives[0]
    if primitive.get("mode", 4) != 4 or not isinstance(primitive.get("attributes"), dict):
        raise mesh.wrong("its mesh is not of triangles")
    return primitive


def _shapes(mesh: Glb, primitive: dict, count: int) -> tuple[tuple[str, ...], NDArray[np.float32]]:
    """The names of the ARKit shapes there, and all 52 [52, count, 3]."""
    extras, targets = mesh.item("meshes", 0).get("extras"), primitive.get("targets")
    names = extras.get("targetNames") if isinstance(extras, dict) else None
    if not isinstance(targets, list) or not isinstance(names, list) or len(names) != len(targets):
        raise mesh.wrong("its shapes have no names: no mesh.extras.targetNames")
    known = [name for name in names if isinstance(name, str) and name in NAMES]
    if not known or len(set(known)) != len(known):
        raise mesh.wrong("none of its shapes bears an ARKit name, or one does twice")
    shapes = np.zeros((len(NAMES), count, 3), np.float32)
    for name, target in zip(names, targets, strict=True):
        if name in known:
            accessor = target.get("POSITION") if isinstance(target, dict) else None
            shapes[NAMES.index(name)] = mesh.array(accessor, f"vertices of {name}", "VEC3", FLOAT, count)
    return tuple(known), shapes


def _viewing(rest: RawGaussians) -> Viewing:
    """Chin to crown; the crown is where splats that cover anything end, stray ones left aside."""
    middle = (np.abs(rest.positions[:, 0]) < 0.1) & (rest.opacity_logits > 0)
    crown = float(np.percentile(rest.positions[middle, 1], 99.8)) if middle.any() else CHIN + 0.25
    height = float(np.clip(crown - CHIN, 0.15, 0.45))
    return Viewing((0.0, CHIN + height / 2, 0.02), height, YAW_LIMIT_DEG, PITCH_LIMIT_DEG)
