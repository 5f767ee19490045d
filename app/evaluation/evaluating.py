"""``gemheads evaluate``: how good avatars are on pictures nothing was learned from, and driven by people never seen."""

import json
import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from typing import Any

from ...models.captures.layout import CaptureError
from ...models.metrics.tables import DIGITS
from ...models.wholefile import open_ordinary, write_whole
from ..errors import ExitCode, InputError, TrainingExtra, UsageError, cannot_write
from ..jobs import check_jobs
from ..machine import cpu_name
from ..making.opencapture import is_capture, is_run, opened
from ..progress import ProgressBar
from ..reenacting.reports import versions
from .drivers import opened_drivers
from .entrants import Entrant, entrants
from .judging import Judged, Lpips, held_out_shots, judge_on, seated
from .report.page import page
from .report.summary import VERSION, about_capture, columns_json
from .sizing import Sizes, check_sizes, judge_sizes
from .strangers import Crossing, CrossingWish, check_crossing, cross

MOST_SHOTS = 1_000_000
JUDGED = "judged"
"""Folder in the report with what is not done again."""
PAGE, FIGURES = "report.html", "report.json"
COMMAND = "gemheads evaluate"
HEAD_BYTES = 1000
"""Of a report's figures: the command that made them stands there."""


@dataclass(frozen=True)
class EvaluateWish:
    """What the command line asks for."""

    against: tuple[str, ...] = ()
    """Names, .gem files or runs."""
    shots: int | None = 24
    """Of each split; None takes all."""
    lpips: Lpips = "vgg"
    crossing: CrossingWish = field(default_factory=CrossingWish)
    """By whom they are driven."""
    components: tuple[int, ...] = ()
    """With how many of its components each GEM is judged, too."""
    jobs: int | None = None
    """How many processes judge; None: as many as are worth it."""


def run_evaluating(avatar: str, capture: Path | None, out: Path, wish: EvaluateWish) -> ExitCode:
    """Judge all avatars by the same pictures and drivers; write ``out``/report.html and report.json.

    Stopped with Ctrl-C it returns INTERRUPTED; then, and after a kill, the same command goes on. Raises CommandError.
    """
    _check(capture, out, wish)
    footage = None if capture is None else opened(capture)
    shots = {} if footage is None else held_out_shots(footage, wish.shots)
    columns = entrants(avatar, wish.against, footage)
    drivers = opened_drivers(wish.crossing.drivers)
    check_sizes(wish.components, columns)
    judged, sizes, crossing = Judged({}, [], {}), None, None
    try:
        (out / JUDGED).mkdir(parents=True, exist_ok=True)  # before hours are spent on what cannot be kept
        with ProgressBar() as bar:
            if drivers:  # first: minutes, and only here is it found whether a driver shows a face
                crossing = cross(drivers, columns, wish.crossing, out / JUDGED, bar)
            if footage is not None:
                with seated(footage, shots, wish.lpips, wish.jobs, out / JUDGED, bar) as jury:
                    judged = judge_on(jury, columns)
                    sizes = judge_sizes(jury, columns, wish.components) if wish.components else None
        about = None if footage is None else about_capture(footage)
        report = _report(_command(avatar, capture, wish), about, columns, judged, sizes, crossing)
        write_whole(out / FIGURES, [(json.dumps(report, indent=1) + "\n").encode()])
        write_whole(out / PAGE, [_page(report, judged, sizes, crossing).encode("utf-8", "replace")])
    except CaptureError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise cannot_write(out, error) from error
    except KeyboardInterrupt:
        print(f"{out}: stopped; what was judged is kept, and the same command continues")
        return ExitCode.INTERRUPTED
    print(_told(out, report, sizes, crossing))
    return ExitCode.OK


def _check(capture: Path | None, out: Path, wish: EvaluateWish) -> None:
    """Whether the command line asks for something that can be."""
    if capture is None and not wish.crossing.drivers:
        raise UsageError("nothing to judge by: give a CAPTURE, or --drivers VIDEO..., or both")
    if wish.shots is not None and not 1 <= wish.shots <= MOST_SHOTS:
        raise UsageError(f"--shots {wish.shots}: choose from 1 to {MOST_SHOTS}, or --all")
    check_jobs(wish.jobs)
    if wish.components and capture is None:
        raise UsageError("--components: give a CAPTURE to judge by")
    if is_capture(out) or is_run(out):
        raise UsageError(f"{out}: is a capture or a training run; name another folder for the report")
    if out.is_file():
        raise UsageError(f"{out}: is a file; name a folder")
    if out.suffix in (".html", ".json"):
        raise UsageError(f"{out}: the report is a folder, such as -o {out.with_suffix('')}")
    for there in (out / name for name in (FIGURES, PAGE)):
        if there.exists() and not _is_report(out / FIGURES):
            raise UsageError(f"{there}: was not written by evaluate, and would be written over; name another folder")
    check_crossing(wish.crossing)
    if capture is None:
        return  # drivers are judged without torch
    with TrainingExtra("evaluating"):
        import_module("...models.train.judging.evaluate", __package__)


def _is_report(figures: Path) -> bool:
    """Whether an earlier evaluation wrote them."""
    try:
        with open_ordinary(figures) as (file, _):
            return f'"command": "{COMMAND} '.encode() in file.read(HEAD_BYTES)
    except OSError:
        return False


def _page(report: Mapping[str, Any], judged: Judged, sizes: Sizes | None, crossing: Crossing | None) -> str:
    return page(report, judged.galleries, sizes and sizes.gallery, crossing and crossing.shown)


def _command(avatar: str, capture: Path | None, wish: EvaluateWish) -> str:
    """The command line, names without the folders of this machine; what has no say in the figures is left out."""
    words = [*COMMAND.split(), Path(avatar).name, *([] if capture is None else [capture.resolve().name])]
    words += ["--against", *(Path(word).name for word in wish.against)] if wish.against else []
    if capture is not None:
        words += ["--all"] if wish.shots is None else ["--shots", str(wish.shots)]
        words += ["--lpips", wish.lpips]
        words += ["--components", *map(str, wish.components)] if wish.components else []
    if wish.crossing.drivers:
        words += ["--drivers", *(Path(word).name for word in wish.crossing.drivers)]
        words += ["--every", str(wish.crossing.every), "--seconds", f"{wish.crossing.seconds:g}"]
    return shlex.join([*words, "-o", "REPORT"])


def _report(
    command: str,
    capture: dict[str, Any] | None,
    columns: Sequence[Entrant],
    judged: Judged,
    sizes: Sizes | None,
    crossing: Crossing | None,
) -> dict[str, Any]:
    """What report.json holds."""
    return {
        "version": VERSION,
        "made": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "command": command,
        "machine": {"processor": cpu_name(), "cores": os.cpu_count()},
        "versions": versions("torch", "flip-evaluator"),
        "capture": capture,
        "avatars": columns_json([entrant.column for entrant in columns]),
        "tables": judged.tables,
        "notes": judged.notes,
        **({} if sizes is None else {"sizes": sizes.figures}),
        **({} if crossing is None else {"crossing": crossing.figures}),
    }


def _told(out: Path, report: Mapping[str, Any], sizes: Sizes | None, crossing: Crossing | None) -> str:
    lines = []
    for table in report["tables"].values():
        for name, means in table["means"].items():
            told = ", ".join(f"{m} {v:.{DIGITS[m]}f}" for m, v in means.items() if v is not None)
            lines.append(f"{table['title']}, {name}: {told} ({len(table['pictures'])} pictures)")
    lines += [] if sizes is None else sizes.said
    lines += [] if crossing is None else crossing.said
    return "\n".join([*lines, *report["notes"], f"{out / PAGE}, {out / FIGURES}"])
