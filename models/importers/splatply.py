"""Splats in the PLY layout of the INRIA 3DGS code, whoever wrote them: properties in any order, extra ones too."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...render.gaussians import RawGaussians
from ...render.rotations import normalized
from ..gem import MAX_SPLATS
from ..ply import SH_C0
from .foreign import ForeignFormatError, opened

CURE = "export it again as binary little-endian PLY of the 3DGS layout"
NEEDED = tuple("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split())
"""Position, colour, opacity logit, ln scale, quaternion wxyz; all float."""
LOGIT_LIMIT = 12.0
"""Opacities are held within this: 0 and 1 as far as any picture shows."""
LOG_SCALE_LIMITS = (-14.0, 3.0)
"""ln m; from a micrometre to 20 m."""
MAX_COORDINATE = 1e3
"""A splat farther away than this is an error of the file."""
_MAX_HEADER_BYTES = 16 * 2**10
_MAX_PROPERTIES = 128
_FLOATS = ("float", "float32")


def read_splats(path: Path, plain_colours: bool = False) -> RawGaussians:
    """The splats of one file, in its own space.

    Of view-dependent colour (``f_rest_*``) only degree 0 is taken: a GEM's colours are the same from every side.

    Args:
        path: binary little-endian PLY whose first and only element is ``vertex``.
        plain_colours: f_dc is RGB in 0..1 itself (LAM) instead of a spherical harmonic's coefficient.

    Raises:
        ForeignFormatError: for anything else.
    """
    table, names = _table(path)
    if missing := [name for name in NEEDED if name not in names]:
        raise ForeignFormatError(path, f"its vertices lack {', '.join(missing)[:80]}: no splats", CURE)
    x = table[:, [names.index(name) for name in NEEDED]]
    if not np.isfinite(x).all():
        raise ForeignFormatError(path, "some of its numbers are not finite", CURE)
    if np.abs(x[:, :3]).max() > MAX_COORDINATE:
        raise ForeignFormatError(path, f"some splats lie farther than {MAX_COORDINATE:g} from its origin", CURE)
    colours = x[:, 3:6] if plain_colours else 0.5 + SH_C0 * x[:, 3:6]
    parts = (
        x[:, :3],
        normalized(x[:, 10:14]),
        np.clip(x[:, 7:10], *LOG_SCALE_LIMITS),
        np.clip(x[:, 6], -LOGIT_LIMIT, LOGIT_LIMIT),
        np.clip(colours, 0, 1),
    )
    return RawGaussians(*(np.ascontiguousarray(part, np.float32) for part in parts))


def column_of(path: Path, name: str) -> NDArray[np.float32] | None:
    """[N] one more property of a file that ``read_splats`` reads; None where it has no such. Raises as that does."""
    table, names = _table(path)
    return table[:, names.index(name)].copy() if name in names else None


def depends_on_view(path: Path) -> bool:
    """Whether a file that ``read_splats`` reads has colours of a higher degree, which are left out."""
    table, names = _table(path)
    rest = [i for i, name in enumerate(names) if name.startswith("f_rest_")]
    return bool(rest) and bool((np.abs(table[:, rest]) > 1e-6).any())


def _table(path: Path) -> tuple[NDArray[np.float32], list[str]]:
    """[N, properties] and their names."""
    with opened(path, CURE) as (file, size):
        start = file.read(_MAX_HEADER_BYTES)
        count, names, payload = _header(path, start)
        wanted = count * 4 * len(names)
        if size != payload + wanted:
            raise ForeignFormatError(
                path, f"its {count} splats need {wanted} bytes, {size - payload} are there", "get the file again"
            )
        file.seek(payload)
        return np.frombuffer(file.read(wanted), "<f4").reshape(count, len(names)), names


def _header(path: Path, start: bytes) -> tuple[int, list[str], int]:
    """How many vertices, the names of their properties, and where they begin."""
    end = start.find(b"\nend_header\n")
    if not start.startswith(b"ply\n") or end < 0:
        raise ForeignFormatError(path, "this is no PLY", "give PLY files of splats")
    lines = [line.split() for line in start[4:end].decode("latin-1").split("\n")]
    lines = [words for words in lines if words and words[0] not in ("comment", "obj_info")]
    form = " ".join(lines[0])[:60] if lines else ""
    if form != "format binary_little_endian 1.0":
        raise ForeignFormatError(path, f"it is written as '{form}', which is not read", CURE)
    if len(lines) < 2 or len(lines[1]) != 3 or lines[1][:2] != ["element", "vertex"]:
        raise ForeignFormatError(path, "its first element is not vertex", CURE)
    number = lines[1][2]
    if not (number.isascii() and number.isdigit()) or len(number) > 9 or not 1 <= int(number) <= MAX_SPLATS:
        raise ForeignFormatError(path, f"it claims {number[:20]} splats, 1 to {MAX_SPLATS} are read", CURE)
    names: list[str] = []
    for words in lines[2:]:
        if len(words) != 3 or words[0] != "property" or words[1] not in _FLOATS:
            raise ForeignFormatError(path, f"its header says '{' '.join(words)[:60]}', expected float properties", CURE)
        names.append(words[2])
    if len(set(names)) != len(names) or len(names) > _MAX_PROPERTIES:
        raise ForeignFormatError(path, "its properties are too many, or one stands twice", CURE)
    return int(number), names, end + len(b"\nend_header\n")
