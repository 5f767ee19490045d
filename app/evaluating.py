"""``gemheads evaluate``: how good avatars are on pictures of a capture that nothing was learned from."""

import importlib.util
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..models.captures.heldout import HELD_OUT, judged_shots
from ..models.captures.layout import CaptureError, Shot
from ..models.captures.reader import Capture
from ..models.captures.staging import Stage
from ..models.metrics.tables import DIGITS
from ..models.wholefile import write_whole
from .bench import cpu_name
from .entrants import Entrant, entrants
from .errors import ExitCode, InputError, OutputError, UsageError, brief
from .evaluation.page import page
from .evaluation.pictures import Gallery, choose
from .evaluation.summary import VERSION, about_capture, columns_json, notes_of, split_table
from .opencapture import opened
from .progress import ProgressBar
from .reports import versions

if TYPE_CHECKING:
    from ..models.train.contestants import Contestant
    from ..models.train.judge import Judge
    from ..models.train.ledger import Record

MOST_SHOTS = 1_000_000
JUDGED = "judged"
"""Folder in the report with what is not done again."""
PAGE, FIGURES = "report.html", "report.json"
Shots = Mapping[str, Sequence[Shot]]
Records = dict[str, dict[str, list["Record"]]]
"""Split -> avatar -> a record for each picture."""


@dataclass(frozen=True)
class EvaluateWish:
    """What the command line asks for."""

    against: tuple[str, ...] = ()
    """Names, .gem files or runs."""
    shots: int | None = 24
    """Of each split; None takes all."""
    lpips: Literal["vgg", "alex", "none"] = "vgg"


def run_evaluating(avatar: str, capture: Path, out: Path, wish: EvaluateWish) -> ExitCode:
    """Judge all avatars on the same pictures and write ``out``/report.html and report.json. Raises CommandError.

    Stopped with Ctrl-C it returns INTERRUPTED; then, and after a kill, the same command goes on.
    """
    try:
        from ..models.train.evaluate import evaluate
        from ..models.train.ledger import Ledger, ShotKeys
    except ImportError as error:
        raise InputError(f"evaluating needs {error.name}; install it: pip install 'gemheads[train]'") from error
    if wish.shots is not None and not 1 <= wish.shots <= MOST_SHOTS:
        raise UsageError(f"--shots {wish.shots}: choose from 1 to {MOST_SHOTS}, or --all")
    if out.suffix in (".html", ".json"):
        raise UsageError(f"{out}: the report is a folder, such as -o {out.with_suffix('')}")
    footage = opened(capture)
    shots = _shots(footage, wish.shots)
    columns = entrants(avatar, wish.against, footage)
    judge, without = _judge(wish.lpips)
    found: Records = {split: {} for split in shots}
    galleries: dict[str, Gallery] = {}
    try:
        keys = ShotKeys(footage, _conditions(judge))
        with ProgressBar() as bar:
            for entrant in columns:
                name, sha256 = entrant.column.name, entrant.column.sha256
                bar.begin(name, sum(map(len, shots.values())))
                contestant = entrant.opened(footage)
                kept = Ledger(out / JUDGED / f"{sha256[:16]}.json", sha256)
                for split, records in evaluate(contestant, footage, shots, judge, kept, keys, bar.advance).items():
                    found[split][name] = records
                _show(name, contestant, footage, shots, found, galleries)
        report = _report(footage, shots, columns, found, without)
        write_whole(out / FIGURES, [(json.dumps(report, indent=1) + "\n").encode()])
        write_whole(out / PAGE, [page(report, galleries).encode()])
    except CaptureError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise OutputError(f"{out}: cannot be written ({error.strerror}); check the folder and the space") from error
    except KeyboardInterrupt:
        print(f"{out}: stopped; what is judged is kept, the same command goes on")
        return ExitCode.INTERRUPTED
    print(_told(out, report))
    return ExitCode.OK


def _shots(footage: Capture, count: int | None) -> Shots:
    shots = {split: judged_shots(footage, split, count) for split in HELD_OUT if footage.shots(split)}
    if not shots:
        raise InputError(
            f"{footage.folder}: has neither a held-out camera (transforms_val.json) nor held-out expressions"
            " (transforms_test.json) to judge by; move some frames there from transforms_train.json, and learn again"
        )
    return shots


def _judge(network: str) -> tuple["Judge", str | None]:
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


def _report(
    footage: Capture, shots: Shots, columns: Sequence[Entrant], found: Records, without: str | None
) -> dict[str, Any]:
    """What report.json holds."""
    tables = {split: split_table(split, footage, judged, found[split]) for split, judged in shots.items()}
    return {
        "version": VERSION,
        "made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "machine": {"processor": cpu_name(), "cores": os.cpu_count()},
        "versions": {**versions(), **{package: _version(package) for package in ("torch", "flip-evaluator")}},
        "capture": about_capture(footage),
        "avatars": columns_json([entrant.column for entrant in columns]),
        "tables": tables,
        "notes": notes_of(tables, [split for split in HELD_OUT if split not in shots], without),
    }


def _told(out: Path, report: Mapping[str, Any]) -> str:
    lines = []
    for table in report["tables"].values():
        for name, means in table["means"].items():
            told = ", ".join(f"{m} {v:.{DIGITS[m]}f}" for m, v in means.items() if v is not None)
            lines.append(f"{table['title']}, {name}: {told} ({len(table['pictures'])} pictures)")
    return "\n".join([*lines, *report["notes"], f"{out / PAGE}, {out / FIGURES}"])


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def _bytes(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.round(255 * np.clip(image, 0, 1)).astype(np.uint8)
