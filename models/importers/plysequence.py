"""Sequences of 3DGS PLY files, one for each frame, splat i the same in all: as ``gemheads export --track`` writes them,
and as animated Gaussian heads are exported elsewhere. The first file is the face at rest."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from ...render.gaussians import RawGaussians
from .foreign import ForeignFormatError, by_number
from .placing import canonical_shift, scaled
from .plysource import ply_source
from .source import Source
from .splatply import read_splats
from .stillness import held_still

MAX_FRAMES = 5000


def ply_files(place: Path) -> list[Path]:
    """The files of a sequence in the order of their numbers: a file, a folder of them, or a pattern (``head_*.ply``).

    Raises ForeignFormatError where there is none, and where there are more than MAX_FRAMES.
    """
    if place.is_file():
        return [place]
    folder, pattern = (place, "*") if place.is_dir() else (place.parent, place.name)
    try:
        found = sorted(folder.glob(pattern), key=by_number) if folder.is_dir() else []
    except ValueError as error:
        raise ForeignFormatError(place, f"is no pattern ({error})", "write one such as 'head_*.ply'") from error
    found = [
        path for path in found if path.suffix.lower() == ".ply" and path.is_file() and not path.name.startswith(".")
    ]
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
    first = scaled(read_splats(files[0]), scale)
    rest = replace(first, positions=first.positions + canonical_shift(first, files[0]))

    def frames() -> Iterator[RawGaussians]:
        for path in files:
            frame = read_splats(path)
            if len(frame) != len(rest):
                what = f"it has {len(frame)} splats, {files[0].name} has {len(rest)}"
                raise ForeignFormatError(path, what, "give frames of one and the same head")
            yield held_still(scaled(frame, scale), rest)

    return ply_source(files[0], "sequence of PLY files", "its first file", rest, len(files), frames)
