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
_OFF_TEMPLATE = 0.15
"""Of the template's height: in good captures half of the vertices rest within a hundredth of it, in other axes half of
the shoulders are off by half of it."""
_LOOKED_AT = 2000
"""Vertices, over the whole mesh, tell as well as all of them where it lies."""
_MAX_PARTS = 256
_TOPOLOGY = "track every moment with the mesh of template.npz"
_OTHER_WORLD = (
    "bring meshes and cameras into the template's axes, about its origin, and into its units, metres; or track that"
    " moment again"
)
_Maybe = NDArray[np.float32] | None
_Stated = tuple[NDArray[np.float32], _Maybe, _Maybe, _Maybe]


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


def read_tracked(path: Path, template: Template) -> Tracked:
    """One moment, the head's pose taken out: as the file states it, else as it is estimated. Raises CaptureError."""
    vertices, rotation, translation, arkit = _read(path, template)
    weights, pivot = template.neck_weights, template.neck_pivot
    if rotation is None or translation is None:
        rotation, translation = estimated(vertices, template.vertices, weights, pivot)
    vertices = unposed(vertices, weights, pivot, rotation, translation).astype(np.float32)
    return Tracked(vertices, np.asarray(rotation, np.float32), np.asarray(translation, np.float32), arkit)


def read_weights(path: Path, template: Template) -> NDArray[np.float32] | None:
    """[52] the ARKit weights of one moment; None where its file has none. Raises CaptureError."""
    return _read(path, template)[-1]


def check_tracked(path: Path, template: Template) -> None:
    """Makes sure that a moment can be read, and lies on the template once the head's pose is taken out.

    In a world of other axes, origin or units the whole way there would be taken for the head's pose, of which shoulders
    have no share, and would tear them off. Raises CaptureError.
    """
    vertices, rotation, translation, _ = _read(path, template)
    some = slice(None, None, 1 + len(vertices) // _LOOKED_AT)
    rest, weights = template.vertices[some], template.neck_weights[some]
    vertices = vertices[some].astype(np.float64)
    if rotation is None or translation is None:
        rotation, translation = estimated(vertices, rest, weights, template.neck_pivot)
    off = np.linalg.norm(unposed(vertices, weights, template.neck_pivot, rotation, translation) - rest, axis=1)
    follows = weights > 0.9
    furthest = max(float(np.median(off[part])) for part in (follows, ~follows) if part.any())
    if furthest > _OFF_TEMPLATE * np.ptp(template.vertices[:, 1]):
        what = f"lies {furthest:.2g} m off the template, the head's pose taken out"
        raise CaptureError(path, what, _OTHER_WORLD)


def _read(path: Path, template: Template) -> _Stated:
    """Vertices, rotation, translation and ARKit weights as they stand in the file. Raises CaptureError."""
    arrays = load_arrays(path, ("vertices", "rotation", "translation", "arkit"))
    vertices = _same_topology(path, arrays, template)
    rotation, translation = (
        floats(path, name, arrays[name], (3,)) if name in arrays else None for name in ("rotation", "translation")
    )
    if (rotation is None) != (translation is None):
        raise CaptureError(path, "has only one of rotation and translation", "give both, or neither")
    arkit = floats(path, "arkit", arrays["arkit"], (len(NAMES),)) if "arkit" in arrays else None
    return vertices, rotation, translation, arkit
