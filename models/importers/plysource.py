"""What is said of a head that comes as splats in PLY files, which tell neither its neck nor its size."""

from collections.abc import Callable, Iterator
from pathlib import Path

from ...render.gaussians import RawGaussians
from .neck import PIVOT, bending
from .placing import VIEWING
from .source import Source
from .splatply import depends_on_view


def ply_source(
    path: Path, kind: str, neutral: str, rest: RawGaussians, count: int, frames: Callable[[], Iterator[RawGaussians]]
) -> Source:
    """The source whose splats were read of ``path``; the others as ``Source`` has them.

    ``neutral``: what its neutral expression is, such as "its first file".
    """
    notes = [f"the neutral expression is {neutral}, and its head is taken to be 25 cm high"]
    if depends_on_view(path):
        notes.append("its colours depend on the view; only their constant part was taken")
    return Source(
        kind=kind,
        splats=len(rest),
        count=count,
        frames=frames,
        rest=rest,
        neck_weights=bending(rest.positions),
        neck_pivot=PIVOT,
        viewing=VIEWING,
        notes=tuple(notes),
    )
