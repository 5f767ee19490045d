"""Avatars on the pictures of a capture that nothing was learned from: what evaluate's first tables hold."""

import hashlib
import importlib.util
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ...models.brevity import brief
from ...models.captures.heldout import HELD_OUT, judged_shots
from ...models.captures.layout import Shot
from ...models.captures.reader import Capture
from ...models.captures.standin import StandIn
from ..errors import InputError
from ..jobs import affordable_jobs
from ..progress import ProgressBar
from .entrants import Entrant
from .report.pictures import Gallery, choose
from .report.summary import notes_of, split_table

if TYPE_CHECKING:
    from ...models.train.judging.contestants import Contestant
    from ...models.train.judging.crew import Crew, Opens
    from ...models.train.judging.judge import Judge
    from ...models.train.judging.ledger import Record, ShotKeys

Shots = Mapping[str, Sequence[Shot]]
Records = dict[str, dict[str, list["Record"]]]
"""Split -> avatar -> a record for each picture."""
Lpips = Literal["vgg", "alex", "none"]
FEW = 32
"""Pictures that one process has judged before others have started."""
MEMORY = 2_000_000_000
"""Bytes that must be free for each process: VGG looks at 802x550 pixels with half of it."""


@dataclass(frozen=True)
class Judged:
    """What was found on a capture's pictures."""

    tables: dict[str, Any]
    """Split -> what report.json holds of it."""
    notes: list[str]
    """What the reader has to know beside the figures."""
    galleries: dict[str, Gallery]
    """Split -> the pictures of the page."""


def held_out_shots(footage: Capture, count: int | None) -> Shots:
    """Split -> ``count`` of its pictures, or all. Raises InputError for a capture without any."""
    shots = {split: judged_shots(footage, split, count) for split in HELD_OUT if footage.shots(split)}
    if not shots:
        raise InputError(
            f"{footage.folder}: has neither a held-out camera (transforms_val.json) nor held-out expressions"
            " (transforms_test.json) to judge by; move some frames there from transforms_train.json, and learn again"
        )
    return shots


@dataclass(frozen=True)
class Jury:
    """Judges avatars on the same pictures of a capture, and knows what it has judged before."""

    footage: Capture
    shots: Shots
    judge: "Judge"
    without: str | None
    """Why LPIPS is not measured."""
    keys: "ShotKeys"
    kept: Path
    """Folder with what is not judged again."""
    crew: "Crew | None"
    """Processes that judge; None: this one alone."""
    bar: ProgressBar

    def records(
        self, title: str, identity: str, opens: "Opens", splits: Sequence[str] = HELD_OUT
    ) -> dict[str, list["Record"]]:
        """Split -> a record for each of its pictures.

        Args:
            title: what the bar says.
            identity: of the avatar as it is judged: what was judged under another one is not believed.
            opens: makes it ready; has to be something that can be pickled.
            splits: of the shots.

        Raises InputError, CaptureError where the capture changed meanwhile, OSError where nothing can be kept.
        """
        from ...models.train.judging.evaluate import Alone, fill
        from ...models.train.judging.ledger import Ledger
        from ...models.train.workers import WorkerLost

        shots = {split: judged for split, judged in self.shots.items() if split in splits}
        self.bar.begin(title, sum(map(len, shots.values())))
        if self.crew is None:
            judging = Alone(opens(self.footage), self.footage, self.judge)
        else:
            judging = self.crew.judging(identity, opens)
        name = hashlib.sha256(identity.encode()).hexdigest()[:16]
        try:
            ledger = Ledger(self.kept / f"{name}.json", identity)
            return fill(judging, shots, ledger, self.keys, self.bar.advance)
        except WorkerLost as error:
            raise InputError(str(error)) from error


@contextmanager
def seated(
    footage: Capture, shots: Shots, lpips: Lpips, jobs: int | None, kept: Path, bar: ProgressBar
) -> Iterator[Jury]:
    """A jury; the processes that it has started end with the block.

    Args:
        footage: where the shots are from.
        shots: what it judges by.
        lpips: network.
        jobs: how many processes; None: as many as are worth it.
        kept: folder.
        bar: is told of every picture.
    """
    from ...models.train.judging.crew import Crew
    from ...models.train.judging.judge import Judge
    from ...models.train.judging.ledger import ShotKeys

    judge, without = _judge(lpips)
    keys = ShotKeys(footage, _conditions(judge))
    count = worth(sum(map(len, shots.values()))) if jobs is None else jobs
    if count == 1:
        yield Jury(footage, shots, judge, without, keys, kept, None, bar)
        return
    with Crew(count, footage, partial(Judge.by, judge.lpips_by)) as crew:
        yield Jury(footage, shots, judge, without, keys, kept, crew, bar)


def worth(pictures: int) -> int:
    """How many processes are worth starting for so many pictures of an avatar on this machine."""
    if pictures < FEW:
        return 1
    return affordable_jobs(MEMORY)


def judge_on(jury: Jury, columns: Sequence[Entrant]) -> Judged:
    """Judges all avatars on the same pictures.

    Raises InputError, CaptureError where the capture changed meanwhile, OSError where nothing can be kept.
    """
    footage, shots = jury.footage, jury.shots
    found: Records = {split: {} for split in shots}
    galleries: dict[str, Gallery] = {}
    for entrant in columns:
        name = entrant.column.name
        for split, records in jury.records(name, entrant.column.sha256, entrant.opened).items():
            found[split][name] = records
            if split not in galleries:  # the first avatar decides which are shown
                galleries[split] = gallery_of(footage, shots[split], records)
            show(galleries[split], name, entrant.opened(footage), footage, shots[split], records)
    tables = {split: split_table(split, footage, judged, found[split]) for split, judged in shots.items()}
    notes = notes_of(tables, [split for split in HELD_OUT if split not in shots], jury.without)
    return Judged(tables, notes, galleries)


def _judge(network: Lpips) -> tuple["Judge", str | None]:
    """The metrics, and why LPIPS is not among them."""
    from ...models.train.judging.judge import Judge
    from ...models.train.perceptual import WeightsMissing

    if network == "none":
        return Judge(None), "--lpips none"
    try:
        return Judge.by(network), None
    except WeightsMissing as error:
        return Judge(None), brief(error)


def _conditions(judge: "Judge") -> tuple[str, ...]:
    """What figures depend on beside pictures and avatar: with another of these all is judged anew."""
    return f"LPIPS {judge.lpips_by}", f"FLIP {importlib.util.find_spec('flip_evaluator') is not None}"


def gallery_of(footage: Capture, shots: Sequence[Shot], records: Sequence["Record"]) -> Gallery:
    """The few pictures that the page holds, as they were taken; how well an avatar did decides which."""
    gallery = Gallery(choose([record.values["PSNR"] or 0.0 for record in records]))
    standin = StandIn(footage)
    for place in sorted(gallery.choice.all):
        gallery.add("", place, _bytes(standin.truth(shots[place])), None)
    gallery.end_row("")
    return gallery


def show(
    gallery: Gallery,
    row: str,
    contestant: "Contestant",
    footage: Capture,
    shots: Sequence[Shot],
    records: Sequence["Record"],
) -> None:
    """Draws them again as an avatar did them, from what was found of it."""
    from ...models.train.synthesis.fit import error_map

    standin = StandIn(footage)
    for place in sorted(gallery.choice.all):
        image = contestant.draw(standin, shots[place], records[place].act)
        gallery.add(row, place, _bytes(image), error_map(image, standin.truth(shots[place])))
    gallery.end_row(row)


def _bytes(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.round(255 * np.clip(image, 0, 1)).astype(np.uint8)
