"""The meshes of a capture: the template, and what was tracked at each moment, checked for fitting each other."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arkit import NAMES
from ..posing import NECK_PIVOT
from .arrays import floats, indices, load_arrays
from .headmotion import estimated, unposed
from .layout import CaptureError, Template, Tracked

_HEAD_METRES = (0.05, 1.5)
"""A template smaller or larger than this is not in metres."""
_MAX_PARTS = 256
_TOPOLOGY = "track every moment with the mesh of template.npz"


def read_template(path: Path) -> Template:
    """The mesh at rest. Raises CaptureError where it is none, or not in metres."""
    names = ("vertices", "triangles", "uv", "uv_triangles", "neck_weights", "neck_pivot", "parts", "part_names")
    arrays = load_arrays(path, names)
    if lacking := [name for name in names[:4] if name not in arrays]:
        raise CaptureError(path, f"has no {', '.join(lacking)}", "docs/captures.md lists what a template holds")
    vertices = floats(path, "vertices", arrays["vertices"], (None, 3))
    triangles = indices(path, "triangles", arrays["triangles"], 3, len(vertices))
    uv = floats(path, "uv", arrays["uv"], (None, 2))
    uv_triangles = indices(path, "uv_triangles", arrays["uv_triangles"], 3, len(uv))
    if len(triangles) < 1 or len(uv_triangles) != len(triangles):
        what = f"has {len(triangles)} triangles and {len(uv_triangles)} in the texture"
        raise CaptureError(path, what, "each triangle needs its uv_triangles row")
    if uv.min() < -1e-3 or uv.max() > 1 + 1e-3:
        raise CaptureError(path, f"has uv in {uv.min():.2f}..{uv.max():.2f}", "lay all parts side by side within 0..1")
    tall = float(np.ptp(vertices[:, 1]))
    if not _HEAD_METRES[0] < tall < _HEAD_METRES[1]:
        raise CaptureError(path, f"is {tall:.3g} high", "give metres, y up, the head looking along +z")
    count = len(vertices)
    weights = floats(path, "neck_weights", arrays.get("neck_weights", np.ones(count, np.float32)), (count,))
    if weights.min() < 0 or weights.max() > 1:
        raise CaptureError(path, f"has neck_weights in {weights.min()}..{weights.max()}", "they are shares in 0..1")
    named = np.atleast_1d(arrays.get("part_names", np.array(["skin"])))
    if named.ndim != 1 or not 1 <= len(named) <= _MAX_PARTS:
        raise CaptureError(path, f"has part_names {list(named.shape)}", f"name 1 to {_MAX_PARTS} parts")
    part_names = tuple(str(name) for name in named)
    parts = arrays.get("parts", np.zeros(len(triangles), np.uint8))
    return Template(
        vertices=vertices,
        triangles=triangles,
        uv=uv,
        uv_triangles=uv_triangles,
        neck_weights=weights,
        neck_pivot=floats(path, "neck_pivot", arrays.get("neck_pivot", np.array(NECK_PIVOT)), (3,)),
        parts=_parts(path, parts, len(triangles), len(part_names)),
        part_names=part_names,
    )


def _parts(path: Path, parts: NDArray[Any], triangles: int, names: int) -> NDArray[np.uint8]:
    if len(np.atleast_1d(parts)) != triangles:
        raise CaptureError(path, f"has {len(np.atleast_1d(parts))} parts for {triangles} triangles", "one a triangle")
    return indices(path, "parts", parts, None, names).astype(np.uint8)


def read_vertices(path: Path, template: Template) -> NDArray[np.float32]:
    """[V, 3] as they stand in the file. Raises CaptureError."""
    arrays = load_arrays(path, ("vertices",))
    return _same_topology(path, arrays, template)


def _same_topology(path: Path, arrays: Mapping[str, NDArray[Any]], template: Template) -> NDArray[np.float32]:
    count = len(template.vertices)
    if "vertices" not in arrays or arrays["vertices"].shape != (count, 3):
        found = "no vertices" if "vertices" not in arrays else f"vertices of shape {arrays['vertices'].shape}"
        raise CaptureError(path, f"has {found}, the template {count} x 3", _TOPOLOGY)
    return floats(path, "vertices", arrays["vertices"], (count, 3))


def read_tracked(path: Path, template: Template, measure: bool = True) -> Tracked:
    """One moment, the head's pose taken out: as the file states it, else as it is estimated.

    Without ``measure`` the moment is only checked. Raises CaptureError.
    """
    arrays = load_arrays(path, ("vertices", "rotation", "translation", "arkit"))
    vertices = _same_topology(path, arrays, template)
    rotation, translation = (
        floats(path, name, arrays[name], (3,)) if name in arrays else None for name in ("rotation", "translation")
    )
    if (rotation is None) != (translation is None):
        raise CaptureError(path, "has only one of rotation and translation", "give both, or neither")
    arkit = floats(path, "arkit", arrays["arkit"], (len(NAMES),)) if "arkit" in arrays else None
    weights, pivot = template.neck_weights, template.neck_pivot
    if rotation is None or translation is None:
        zero = np.zeros(3, np.float32)
        rotation, translation = estimated(vertices, template.vertices, weights, pivot) if measure else (zero, zero)
    if measure:
        vertices = unposed(vertices, weights, pivot, rotation, translation).astype(np.float32)
    return Tracked(vertices, np.asarray(rotation, np.float32), np.asarray(translation, np.float32), arkit)
