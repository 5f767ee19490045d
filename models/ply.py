"""Splats as PLY files under the names of the INRIA 3DGS code, which SuperSplat and other viewers open."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..render.gaussians import RawGaussians
from ..render.rotations import normalized
from .gem import MAX_SPLATS
from .wholefile import write_whole

SH_C0 = 0.28209479177387814
"""The constant spherical harmonic: colour = 0.5 + SH_C0 * f_dc."""
PROPERTIES = tuple(
    "x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3".split()
)
"""float32 each: position m, normal (zeros), colour, opacity logit, ln m, quaternion wxyz."""
_MAX_HEADER_BYTES = 4096


def save_ply(raw: RawGaussians, path: str | Path) -> None:
    """Writes splats as binary little-endian PLY; the file appears whole or not at all.

    Raises OSError where it cannot be written.
    """
    table = np.zeros((len(raw), len(PROPERTIES)), "<f4")
    table[:, 0:3] = raw.positions
    table[:, 6:9] = (raw.colors - 0.5) / SH_C0
    table[:, 9] = raw.opacity_logits
    table[:, 10:13] = raw.log_scales
    # unit quaternions: not every viewer normalises
    table[:, 13:17] = normalized(raw.wxyz)
    write_whole(Path(path), [_header(len(raw)), table.data])


def save_ply_sequence(frames: Iterable[RawGaussians], folder: str | Path) -> None:
    """Writes frame_000000.ply, frame_000001.ply ... Raises OSError."""
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(frames):
        save_ply(frame, place / f"frame_{number:06d}.ply")


def load_ply(path: str | Path) -> RawGaussians:
    """Reads what ``save_ply`` writes: exactly its header, nothing more general.

    Raises ValueError for any other file, before memory is taken for it.
    """
    place = Path(path)
    with place.open("rb") as file:
        start = file.read(_MAX_HEADER_BYTES)
        count = _count(start)
        if count is None or not start.startswith(_header(count)):
            raise ValueError(f"{place}: not a PLY of splats as this program writes them; export it again")
        wanted = count * len(PROPERTIES) * 4
        if place.stat().st_size != len(_header(count)) + wanted:
            raise ValueError(f"{place}: cut off or too long for its {count} splats; export it again")
        file.seek(len(_header(count)))
        table = np.frombuffer(file.read(wanted), "<f4").reshape(count, len(PROPERTIES)).astype(np.float32)
    return RawGaussians(*_columns(table))


def _columns(table: NDArray[np.float32]) -> tuple[NDArray[np.float32], ...]:
    """Positions, quaternions, log scales, logits and colours of a table [N, 17]."""
    colors = (0.5 + SH_C0 * table[:, 6:9]).astype(np.float32)
    parts = (table[:, 0:3], table[:, 13:17], table[:, 10:13], table[:, 9], colors)
    return tuple(np.ascontiguousarray(part) for part in parts)


def _header(count: int) -> bytes:
    fields = "".join(f"property float {name}\n" for name in PROPERTIES)
    return f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{fields}end_header\n".encode()


def _count(start: bytes) -> int | None:
    words = start.split(b"\n", 3)[2].split() if start.count(b"\n") >= 3 else []
    if len(words) != 3 or words[:2] != [b"element", b"vertex"] or not words[2].isdigit() or len(words[2]) > 8:
        return None
    count = int(words[2])
    return count if count <= MAX_SPLATS else None
