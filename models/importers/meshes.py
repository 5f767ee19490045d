"""A mesh in motion from files that nobody vouches for: numbered .npz or .obj, or one .npz with all frames."""

from array import array
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..captures.arrays import load_arrays
from ..captures.layout import CaptureError
from .foreign import ForeignFormatError, by_number, opened
from .splatply import MAX_COORDINATE

CURE = "give .npz files with vertices [V, 3] and triangles [T, 3], or .obj files of triangles"
MAX_FRAMES = 5000
MAX_VERTICES = 200_000
MAX_TRIANGLES = 500_000
MAX_NPZ_BYTES = 2**28
"""Unpacked; FLAME's 5,023 vertices in 4,000 frames take 230 MiB."""
MAX_OBJ_BYTES = 2**26
"""FLAME's 5,023 vertices take half a megabyte."""
MAX_OBJ_LINES = 2**21
"""Three a vertex and a triangle."""
TEMPLATE = "template.npz"
"""Beside the meshes or a folder up: where the triangles are when the meshes do not repeat them."""
_TRIANGLES = ("triangles", "faces")


@dataclass(frozen=True)
class MeshSequence:
    """One mesh, frame by frame; only one frame at a time is read."""

    place: Path
    triangles: NDArray[np.int64]
    """[T, 3]"""
    count: int
    """F."""
    vertices: Callable[[int], NDArray[np.float32]]
    """[V, 3] of a frame, in the files' own units. Raises ForeignFormatError."""


def open_meshes(place: Path) -> MeshSequence:
    """Finds the frames and reads the first.

    Args:
        place: a folder of ``.npz`` or ``.obj`` files, which sort by the last number in their names; or one ``.npz``
            with vertices [F, V, 3]. Triangles (``triangles`` or ``faces``, from 0) are those of the first file, or of
            a ``template.npz`` in the folder or around it.

    Raises:
        ForeignFormatError: for anything else.
    """
    files = _files(place)
    if files[0].suffix == ".obj":
        first, triangles = _obj(files[0])
        whole = None
    else:
        first, triangles = _npz(files[0])
        whole = first if first.ndim == 3 else None
    if triangles is None:
        triangles = _template(files[0])
    count = first.shape[-2]
    if not 1 <= len(triangles) <= MAX_TRIANGLES or triangles.min() < 0 or triangles.max() >= count:
        raise ForeignFormatError(files[0], f"its triangles are none of its {count} vertices", CURE)
    if whole is not None:
        if len(files) > 1:
            raise ForeignFormatError(files[0], "several frames in one file, and other files beside it", CURE)
        return MeshSequence(place, triangles, len(whole), lambda index: whole[index])

    def vertices(index: int) -> NDArray[np.float32]:
        path = files[index]
        values = (_obj(path) if path.suffix == ".obj" else _npz(path))[0]
        if values.shape != (count, 3):
            found = "x".join(map(str, values.shape))
            raise ForeignFormatError(path, f"has vertices of {found}, the first file {count}x3", "give one topology")
        return values

    return MeshSequence(place, triangles, len(files), vertices)


def _files(place: Path) -> list[Path]:
    if place.is_file():
        return [place]
    found = [path for path in place.iterdir() if path.suffix in (".npz", ".obj")] if place.is_dir() else []
    found = sorted((path for path in found if path.name != TEMPLATE and not path.name.startswith(".")), key=by_number)
    if not found:
        raise ForeignFormatError(place, "there is no mesh", CURE)
    if len(found) > MAX_FRAMES:
        raise ForeignFormatError(place, f"{len(found)} meshes, at most {MAX_FRAMES} are read", "leave some out")
    return found


def _npz(path: Path) -> tuple[NDArray[np.float32], NDArray[np.int64] | None]:
    """Vertices [V, 3] or [F, V, 3], and the triangles where they are in it."""
    try:
        arrays = load_arrays(path, ("vertices", *_TRIANGLES), MAX_NPZ_BYTES)
    except (CaptureError, MemoryError) as error:
        what = error.what if isinstance(error, CaptureError) else "claims more than there is memory"
        raise ForeignFormatError(path, what, CURE) from error
    if "vertices" not in arrays or arrays["vertices"].ndim not in (2, 3) or arrays["vertices"].dtype.kind not in "fiu":
        raise ForeignFormatError(path, "has no vertices [V, 3] or [F, V, 3]", CURE)
    frames = arrays["vertices"].shape[0] if arrays["vertices"].ndim == 3 else 1
    if not 1 <= frames <= MAX_FRAMES:
        raise ForeignFormatError(path, f"has {frames} frames, 1 to {MAX_FRAMES} are read", "leave some out")
    named = [arrays[name] for name in _TRIANGLES if name in arrays]
    triangles = named[0] if named else None
    if triangles is not None and (triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu"):
        raise ForeignFormatError(path, f"has triangles of {triangles.dtype}{list(triangles.shape)}", CURE)
    return _checked(path, arrays["vertices"]), None if triangles is None else triangles.astype(np.int64)


def _template(first: Path) -> NDArray[np.int64]:
    for folder in (first.parent, first.parent.parent):
        if (folder / TEMPLATE).is_file():
            triangles = _npz(folder / TEMPLATE)[1]
            if triangles is not None:
                return triangles
    raise ForeignFormatError(first, f"has no triangles, and no {TEMPLATE} with such lies beside it", CURE)


def _obj(path: Path) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    vertices, triangles = array("d"), array("q")
    with opened(path, CURE) as (file, size):
        if size > MAX_OBJ_BYTES:
            raise ForeignFormatError(path, f"{size} bytes are more than the {MAX_OBJ_BYTES} of an .obj", CURE)
        for number, line in enumerate(file):
            if number == MAX_OBJ_LINES or len(vertices) > 3 * MAX_VERTICES or len(triangles) > 3 * MAX_TRIANGLES:
                what = f"has more than {MAX_VERTICES} vertices, {MAX_TRIANGLES} triangles or {MAX_OBJ_LINES} lines"
                raise ForeignFormatError(path, what, CURE)
            if not line.startswith((b"v ", b"f ")):
                continue
            kind, *words = line.split(None, 4)
            if len(words) < 3 or (kind == b"f" and len(words) > 3):
                raise ForeignFormatError(path, f"has neither vertex nor triangle in line {number + 1}", CURE)
            try:
                if kind == b"v":
                    vertices.extend(map(float, words[:3]))
                else:
                    triangles.extend([int(word.split(b"/", 1)[0]) for word in words])
            except (ValueError, OverflowError) as error:
                raise ForeignFormatError(path, f"has no numbers in line {number + 1}", CURE) from error
    if not triangles:
        raise ForeignFormatError(path, "has no faces", CURE)
    corners = np.array(triangles, np.int64).reshape(-1, 3)
    return _checked(path, np.array(vertices, np.float64).reshape(-1, 3)), corners - 1


def _checked(path: Path, vertices: NDArray[np.generic]) -> NDArray[np.float32]:
    if vertices.ndim < 2 or vertices.shape[-1] != 3 or not 3 <= vertices.shape[-2] <= MAX_VERTICES:
        raise ForeignFormatError(path, f"has vertices of {list(vertices.shape)}", CURE)
    with np.errstate(over="ignore"):
        values = np.ascontiguousarray(vertices, np.float32)
    if not np.isfinite(values).all() or np.abs(values).max() > MAX_COORDINATE:
        raise ForeignFormatError(path, f"has vertices that are not finite, or beyond {MAX_COORDINATE:g}", CURE)
    return values
