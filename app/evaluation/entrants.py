"""Who is judged by ``gemheads evaluate``: avatars and runs, each opened when its turn comes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ...models.captures.layout import CaptureError
from ...models.captures.reader import Capture
from ...models.wholefile import file_sha256
from ..errors import InputError, UsageError
from ..library import find_avatar
from ..making.opencapture import is_run
from ..performing.casting import open_avatar
from .report.summary import Column

if TYPE_CHECKING:
    from ...models.train.avatars.runs import Run
    from ...models.train.judging.contestants import Contestant

FITTED = "fitted in other cameras' pictures"
"""How a GEM comes to its expressions on a capture (models.train.contestants)."""


@dataclass(frozen=True)
class Entrant:
    """One column of the tables; only its figures stay in memory."""

    path: Path
    column: Column

    def opened(self, capture: Capture) -> "Contestant":
        """Ready to act. Raises InputError."""
        from ...models.train.judging.contestants import GemContestant, RunContestant

        if is_run(self.path):
            return RunContestant(_opened_run(self.path, capture))
        return GemContestant(open_avatar(self.path).gem, capture)


def entrants(avatar: str, against: Sequence[str], capture: Capture | None) -> list[Entrant]:
    """All that are judged, each opened once, so that what cannot be used is told before anything begins.

    Args:
        avatar: a name, a .gem file or a run: the first column.
        against: the same, for the others.
        capture: what they are judged on; None where only drivers judge, which a run cannot follow.

    Raises InputError, and UsageError for one that is given twice.
    """
    found: list[Entrant] = []
    for word in (avatar, *against):
        path = Path(word) if is_run(Path(word)) else find_avatar(word)
        taken = {entrant.column.name for entrant in found}
        entrant = Entrant(path, _column(path, taken, capture))
        if any(other.column.sha256 == entrant.column.sha256 for other in found):
            raise UsageError(f"--against {word}: is given twice; each avatar is one column")
        found.append(entrant)
    return found


def _column(path: Path, taken: set[str], capture: Capture | None) -> Column:
    name = _name(path, taken)
    if is_run(path):
        if capture is None:
            raise InputError(f"{path}: a run is judged on a capture; for drivers alone make a .gem of it (distill)")
        from ...models.train.avatars.runs import CHECKPOINT

        run = _opened_run(path, capture)
        file = path / CHECKPOINT
        source = f"a run of {run.step} of {run.plan.steps} steps, {run.plan.views} pictures each"
        return Column(
            name=name,
            kind=run.avatar.title,
            driven_by=run.avatar.driven_by,
            sha256=file_sha256(file),
            splats=len(run.texels),
            components=None,
            megabytes=file.stat().st_size / 1e6,
            source=source,
            steps=run.step,
            seconds=run.seconds,
        )
    cast = open_avatar(path)
    gem, size = cast.gem, path.stat().st_size / 1e6
    source = gem.about.get("source", "") or "not stated"
    driven_by = "drivers" if capture is None else FITTED
    return Column(name, "GEM", driven_by, cast.sha256, len(gem), gem.components, size, source)


def _name(path: Path, taken: set[str]) -> str:
    """The file's, with its folder's where two are called the same."""
    path = path.resolve()
    short = path.stem if path.suffix == ".gem" else path.name
    names = (short, f"{path.parent.name}/{short}", *(f"{short} ({number})" for number in range(2, len(taken) + 3)))
    return next(name for name in names if name not in taken)


def _opened_run(path: Path, capture: Capture) -> "Run":
    from ...models.train.avatars.runs import RunError, open_run

    try:
        return open_run(path, capture.folder)
    except (RunError, CaptureError) as error:
        raise InputError(str(error)) from error
