"""Judging an avatar on the held-out pictures of a capture, picture by picture."""

from collections.abc import Callable, Mapping, Sequence

from ..captures.layout import Shot
from ..captures.reader import Capture
from ..captures.staging import Stage
from .contestants import Contestant
from .judge import Judge
from .ledger import Ledger, Record, ShotKeys

Shots = Mapping[str, Sequence[Shot]]
"""Split -> the pictures that are judged."""


def evaluate(
    contestant: Contestant,
    capture: Capture,
    shots: Shots,
    judge: Judge,
    ledger: Ledger,
    keys: ShotKeys,
    progress: Callable[[], None] = lambda: None,
) -> dict[str, list[Record]]:
    """Split -> a record for each of ``shots``; those in the ledger are not judged again. One picture is in memory.

    ``progress`` is called after each. Whatever stops it, the ledger has been saved.
    Raises CaptureError where the capture changed since it was opened, OSError where the ledger cannot be written.
    """
    stage = Stage(capture)
    found: dict[str, list[Record]] = {split: [] for split in shots}
    try:
        for split, judged in shots.items():
            for shot in judged:
                key = keys.key(split, shot)
                record = ledger.get(key)
                if record is None:
                    act = contestant.act(shot, split)
                    image = contestant.draw(stage, shot, act)
                    record = Record(act, judge.measured(image, stage.truth(shot)))
                    ledger.put(key, record)
                found[split].append(record)
                progress()
    finally:
        ledger.save()
    return found
