"""Judging an avatar on the held-out pictures of a capture, picture by picture."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Protocol

from ...captures.layout import Shot
from ...captures.reader import Capture
from ...captures.standin import StandIn
from ..threads import one_thread
from .contestants import Contestant
from .judge import Judge
from .ledger import Ledger, Record, ShotKeys

Shots = Mapping[str, Sequence[Shot]]
"""Split -> the pictures that are judged."""


@dataclass(frozen=True)
class Moment:
    """Pictures of one moment that are to be judged: what an avatar does is looked for once for most of them."""

    split: str
    shots: tuple[Shot, ...]
    keys: tuple[str, ...]
    """Of the ledger, one for each shot."""


class Judging(Protocol):
    """Whoever judges one avatar: this process, or several."""

    def records(self, moments: Sequence[Moment]) -> Iterator[tuple[str, Record]]:
        """Key and record of each picture, as soon as it is judged, in any order. Raises CaptureError."""
        ...


@dataclass(frozen=True)
class Alone:
    """This process judges, one moment after the other."""

    contestant: Contestant
    capture: Capture
    judge: Judge

    def records(self, moments: Sequence[Moment]) -> Iterator[tuple[str, Record]]:
        """See ``Judging``; in order."""
        standin = StandIn(self.capture)
        for moment in moments:
            yield from judged(self.contestant, standin, self.judge, moment)


def judged(contestant: Contestant, standin: StandIn, judge: Judge, moment: Moment) -> Iterator[tuple[str, Record]]:
    """Key and record of each picture of a moment, computed in one thread. Raises CaptureError."""
    for key, shot in zip(moment.keys, moment.shots, strict=True):
        with one_thread():
            act = contestant.act(shot, moment.split)
            record = Record(act, judge.measured(contestant.draw(standin, shot, act), standin.truth(shot)))
        yield key, record


def fill(
    judging: Judging, shots: Shots, ledger: Ledger, keys: ShotKeys, progress: Callable[[], None] = lambda: None
) -> dict[str, list[Record]]:
    """Split -> a record for each of ``shots``; those in the ledger are not judged again.

    ``progress`` is called after each. Whatever stops it, the ledger has been saved.
    Raises CaptureError where the capture changed since it was opened, OSError where the ledger cannot be written.
    """
    named = {split: [keys.key(split, shot) for shot in of] for split, of in shots.items()}
    left: list[Moment] = []
    for split, of in shots.items():
        unknown = [pair for pair in zip(of, named[split], strict=True) if ledger.get(pair[1]) is None]
        for _, views in groupby(unknown, key=lambda pair: pair[0].timestep):
            left.append(Moment(split, *zip(*views, strict=True)))
    for _ in range(sum(map(len, named.values())) - sum(len(moment.keys) for moment in left)):
        progress()
    try:
        for key, record in judging.records(left) if left else ():
            ledger.put(key, record)
            progress()
    finally:
        ledger.save()
    return {split: [_found(ledger, key) for key in of] for split, of in named.items()}


def _found(ledger: Ledger, key: str) -> Record:
    record = ledger.get(key)
    if record is None:
        raise RuntimeError(f"a picture was left unjudged ({key[:8]}): whoever judges must answer for each")
    return record
