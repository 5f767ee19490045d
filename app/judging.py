"""Avatars on the pictures of a capture that nothing was learned from: what evaluate's first tables hold."""

import importlib.util
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..models.captures.heldout import HELD_OUT, judged_shots
from ..models.captures.layout import Shot
from ..models.captures.reader import Capture
from ..models.captures.staging import Stage
from .entrants import Entrant
from .errors import InputError, brief
from .evaluation.pictures import Gallery, choose
from .evaluation.summary import notes_of, split_table
from .progress import ProgressBar

if TYPE_CHECKING:
    from ..models.train.contestants import Contestant
    from ..models.train.judge import Judge
    from ..models.train.ledger import Record

Shots = Mapping[str, Sequence[Shot]]
Records = dict[str, dict[str, list["Record"]]]
"""Split -> avatar -> a record for each picture."""
Lpips = Literal["vgg", "alex", "none"]


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


def judge_on(
    footage: Capture, shots: Shots, columns: Sequence[Entrant], lpips: Lpips, kept: Path, bar: ProgressBar
) -> Judged:
    """Judges all avatars on the same pictures; what the folder ``kept`` holds is not judged again.

    Raises InputError, CaptureError where the capture changed meanwhile, OSError where nothing can be kept.
    """
    from ..models.train.evaluate import evaluate
    from ..models.train.ledger import Ledger, ShotKeys

    judge, without = _judge(lpips)
    found: Records = {split: {} for split in shots}
    galleries: dict[str, Gallery] = {}
    keys = ShotKeys(footage, _conditions(judge))
    for entrant in columns:
        name, sha256 = entrant.column.name, entrant.column.sha256
        bar.begin(name, sum(map(len, shots.values())))
        contestant = entrant.opened(footage)
        ledger = Ledger(kept / f"{sha256[:16]}.json", sha256)
        for split, records in evaluate(contestant, footage, shots, judge, ledger, keys, bar.advance).items():
            found[split][name] = records
        _show(name, contestant, footage, shots, found, galleries)
    tables = {split: split_table(split, footage, judged, found[split]) for split, judged in shots.items()}
    return Judged(tables, notes_of(tables, [split for split in HELD_OUT if split not in shots], without), galleries)


def _judge(network: Lpips) -> tuple["Judge", str | None]:
    """The metrics, and why LPIPS is not among them."""
    from ..models.train.judge import Judge
    from ..models.train.perceptual import Perceptual, WeightsMissing
    from ..models.train.runs import default_device

    if network == "none":
        return Judge(None), "--lpips none"
    device = default_device()
    try:
        return Judge(Perceptual(network, device), device), None
    except WeightsMissing as error:
        return Judge(None), brief(error)


def _conditions(judge: "Judge") -> tuple[str, ...]:
    """What figures depend on beside pictures and avatar: with another of these all is judged anew."""
    return f"LPIPS {judge.lpips_by}", f"FLIP {importlib.util.find_spec('flip_evaluator') is not None}"


def _show(
    name: str, contestant: "Contestant", footage: Capture, shots: Shots, found: Records, galleries: dict[str, Gallery]
) -> None:
    """Draws the few pictures that the page holds again, from what was found; the first avatar decides which."""
    from ..models.train.fit import error_map

    stage = Stage(footage)
    for split, judged in shots.items():
        records = found[split][name]
        first = split not in galleries
        if first:
            galleries[split] = Gallery(choose([record.values["PSNR"] or 0.0 for record in records]))
        gallery = galleries[split]
        places = sorted(gallery.choice.all)
        if first:
            for place in places:
                gallery.add("", place, _bytes(stage.truth(judged[place])), None)
            gallery.end_row("")
        for place in places:
            image = contestant.draw(stage, judged[place], records[place].act)
            gallery.add(name, place, _bytes(image), error_map(image, stage.truth(judged[place])))
        gallery.end_row(name)


def _bytes(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.round(255 * np.clip(image, 0, 1)).astype(np.uint8)
