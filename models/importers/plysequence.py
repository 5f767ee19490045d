"""Sequences of 3DGS PLY files, one for each frame, splat i the same in all: as ``gemheads export --track`` writes them,
and as animated Gaussian heads are exported elsewhere. The first file is the face at rest."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...render.gaussians import RawGaussians
from ..gem import Viewing
from .foreign import ForeignFormatError
from .neck import CHIN, PIVOT, bending
from .source import Source
from .splatply import depends_on_view, read_splats
from .stillness import held_still

MAX_FRAMES = 5000
HEAD_HEIGHT = 0.25
"""Chin to crown, hair included, metres; what the splats themselves do not tell."""
_SIZES = (0.15, 2.0)
"""Metres: how high heads are, with all that is below them."""
_SCALE_CURE = "give --scale, the metres of one of its units"


def ply_files(place: Path) -> list[Path]:
    """The files of a sequence in the order of their numbers: a file, a folder of them, or a pattern (``head_*.ply``).

    Raises ForeignFormatError where there is none, and where there are more than MAX_FRAMES.
    """
    if place.is_file():
        return [place]
    folder, pattern = (place, "*.ply") if place.is_dir() else (place.parent, place.name)
    found = sorted(folder.glob(pattern), key=_number) if folder.is_dir() else []
    found = [path for path in found if path.suffix == ".ply" and path.is_file()]
    if not found:
        raise ForeignFormatError(place, "there is no PLY file", "give a folder of PLY files, or a pattern in quotes")
    if len(found) > MAX_FRAMES:
        raise ForeignFormatError(place, f"{len(found)} files, at most {MAX_FRAMES} are read", "leave some out")
    return found


def open_sequence(place: Path, scale: float = 1.0) -> Source:
    """A sequence of PLY files; only one frame at a time is in memory.

    Args:
        place: as for ``ply_files``.
        scale: metres of one of the files' units; y is up in them, and the face looks along +z.

    Raises:
        ForeignFormatError: now for the first file, later, from ``frames``, for any other.
    """
    files = ply_files(place)
    first = _scaled(read_splats(files[0]), scale)
    solid = first.opacity_logits > 0
    points = first.positions[solid if solid.any() else slice(None)]
    low, high = np.percentile(points, [0.5, 99.8], axis=0)
    if not _SIZES[0] <= high[1] - low[1] <= _SIZES[1]:
        raise ForeignFormatError(files[0], f"its splats are {high[1] - low[1]:.3g} m high, no head is", _SCALE_CURE)
    head = points[points[:, 1] > high[1] - HEAD_HEIGHT]
    middle = (np.percentile(head, 1, axis=0) + np.percentile(head, 99, axis=0)) / 2
    # crown and sides of the head go where the canonical ones are; its depth is told by nose and nape
    shift = np.array([-middle[0], CHIN + HEAD_HEIGHT - high[1], -middle[2]], np.float32)
    rest = replace(first, positions=first.positions + shift)

    def frames() -> Iterator[RawGaussians]:
        for path in files:
            frame = read_splats(path)
            if len(frame) != len(rest):
                what = f"it has {len(frame)} splats, {files[0].name} has {len(rest)}"
                raise ForeignFormatError(path, what, "give frames of one and the same head")
            yield held_still(_scaled(frame, scale), rest)

    notes = ["the neutral expression is its first file, and its head is taken to be 25 cm high"]
    if depends_on_view(files[0]):
        notes.append("its colours depend on the view; only their constant part was taken")
    return Source(
        kind="sequence of PLY files",
        splats=len(rest),
        count=len(files),
        frames=frames,
        rest=rest,
        neck_weights=bending(rest.positions),
        neck_pivot=PIVOT,
        viewing=Viewing((0.0, CHIN + HEAD_HEIGHT / 2, 0.02), HEAD_HEIGHT),
        notes=tuple(notes),
    )


def _scaled(raw: RawGaussians, scale: float) -> RawGaussians:
    if scale == 1:
        return raw
    log_scales = raw.log_scales + np.float32(np.log(scale))
    return replace(raw, positions=raw.positions * np.float32(scale), log_scales=log_scales)


def _number(path: Path) -> tuple[int, str]:
    """Frames sort by the last number in their name, so that 10 comes after 9."""
    numbers = re.findall(r"\d+", path.stem)
    return (int(numbers[-1][-18:]) if numbers else -1, path.name)
