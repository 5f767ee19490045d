"""``gemheads capture``: a synthetic person performs before many cameras, into the folder that `train` learns from."""

import json
import re
from dataclasses import asdict
from pathlib import Path

from ...models.captures.writer import CaptureWriter
from ...models.studio.blender import BlenderError
from ...models.studio.shoot import Plan, require_renderer, shoot
from ...models.studio.subject import SubjectError, load_subject
from ...models.wholefile import write_whole
from ..errors import ExitCode, InputError, UsageError, cannot_write
from ..progress import ProgressBar

ORDER = "shooting.json"
"""What was asked for: only the same is gone on with."""
MOST_CAMERAS = 100
MOST_MOMENTS = 100_000
MOST_NOISE_MM = 20.0


def run_capturing(out: Path, name: str, plan: Plan) -> ExitCode:
    """Draw a capture, or what is lacking of it. Raises CommandError."""
    _check(plan)
    try:
        require_renderer(plan.renderer)
        subject = load_subject(name)
    except (BlenderError, SubjectError) as error:
        raise InputError(str(error)) from error
    try:
        _claim(out, {"subject": name, **json.loads(json.dumps(asdict(plan)))})
        with ProgressBar() as bar:
            done = shoot(subject, plan, CaptureWriter(out), bar.reach)
    except BlenderError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise cannot_write(out, error) from error
    kept = f", {done.pictures - done.drawn} were there" if done.drawn < done.pictures else ""
    print(f"{out}: {done.pictures} pictures of {plan.train} + {plan.test} moments from {plan.cameras} cameras{kept}")
    return ExitCode.OK


def read_split(text: str) -> tuple[int, int]:
    """Moments to learn from and moments held out, of ``96+32``. Raises UsageError."""
    match = re.fullmatch(r"(\d{1,6})\+(\d{1,6})", text.strip())
    if not match:
        raise UsageError(f"--split {text}: not a split; use moments to learn from + moments held out, such as 96+32")
    return int(match[1]), int(match[2])


def _check(plan: Plan) -> None:
    if not 2 <= plan.cameras <= MOST_CAMERAS:
        raise UsageError(f"--cameras {plan.cameras}: must be from 2 (one is held out) to {MOST_CAMERAS}")
    if plan.held_out is not None and not 0 <= plan.held_out < plan.cameras:
        raise UsageError(f"--held-out {plan.held_out}: the cameras are 0 to {plan.cameras - 1}")
    if not 1 <= plan.train <= plan.train + plan.test <= MOST_MOMENTS:
        raise UsageError(
            f"--split {plan.train}+{plan.test}: at least 1 moment to learn from, at most {MOST_MOMENTS} in all"
        )
    if not 0 <= plan.tracking_noise_m <= MOST_NOISE_MM / 1000:
        raise UsageError(f"--tracking-noise {1000 * plan.tracking_noise_m:g}: must be from 0 to {MOST_NOISE_MM:g} mm")


def _claim(out: Path, order: dict[str, object]) -> None:
    """Make the folder ours, or see that it is this very capture. Raises UsageError, InputError, OSError."""
    if out.exists() and not out.is_dir():
        raise UsageError(f"{out}: is a file; name a folder")
    note = out / ORDER
    if note.is_file():
        try:
            before = json.loads(note.read_text())
        except ValueError as error:
            raise InputError(f"{note}: is broken ({error}); remove {out} and capture anew") from error
        # captures from before there was a choice say nothing of it
        known = {"renderer": "studio", **before} if isinstance(before, dict) else {}
        if known != order:
            other = [key for key in order if known.get(key) != order[key]]
            raise UsageError(
                f"{out}: holds a capture with another {', '.join(other)}; name another folder, or remove it"
            )
        return
    if out.exists() and any(out.iterdir()):
        raise UsageError(f"{out}: holds something else; name a new or an empty folder")
    out.mkdir(parents=True, exist_ok=True)
    write_whole(note, [json.dumps(order, indent=1).encode()])
