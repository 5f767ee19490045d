"""``evaluate --components``: what fewer components cost in quality, and what they save in bytes and time (Table 4)."""

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from ...models.captures.reader import Capture
from ...models.gem import Gem
from ...models.gemfile import save_gem
from ...render.camera import Camera
from ...render.engines import Engine, open_engine
from ...render.gaussians import RawGaussians
from ..errors import UsageError
from ..making.opencapture import is_run
from ..performing.casting import open_avatar
from .entrants import Entrant
from .judging import Jury, gallery_of, show
from .report.pictures import Gallery
from .report.sizes import Pace, Variant, sizes_json, sizes_said

if TYPE_CHECKING:
    from ...models.train.judging.contestants import Contestant
    from ...models.train.judging.ledger import Record

ROUNDS = 15
"""Frames in a median ..."""
PATIENCE = 60.0
"""... where they take no longer than so many seconds, three at least."""
WARM = 12
"""Frames before they count: in them the engine is chosen."""
Frame = Callable[[], RawGaussians]
"""Another expression's splats each time."""


@dataclass(frozen=True)
class Sizes:
    """What was found."""

    figures: dict[str, Any]
    """What report.json holds of it."""
    gallery: Gallery
    """Pictures of the page."""
    said: list[str]
    """Lines for the terminal."""


@dataclass(frozen=True)
class _Candidate:
    """A variant, and how it is judged."""

    variant: Variant
    identity: str
    """What it is judged under."""
    opens: Callable[[Capture], "Contestant"]
    frame: Callable[[Capture], Frame]


def check_sizes(counts: Sequence[int], columns: Sequence[Entrant]) -> None:
    """Raises UsageError where no GEM has so many components, or any."""
    if not counts:
        return
    stored = [entrant.column.components for entrant in columns if entrant.column.components is not None]
    most = max(stored, default=0)
    for wanted in counts:
        if not stored:
            raise UsageError(f"--components {wanted}: none of the avatars is a .gem; leave it out")
        if not most:
            raise UsageError(f"--components {wanted}: no .gem among the avatars moves, so it has none; leave it out")
        if not 1 <= wanted <= most:
            raise UsageError(f"--components {wanted}: choose from 1 to {most}")


def judge_sizes(jury: Jury, columns: Sequence[Entrant], counts: Sequence[int]) -> Sizes:
    """Judges each GEM with ``counts`` components on the expressions held out, and each run as it is.

    Every GEM stays in memory until all have been timed in turns. Raises what ``Jury.records`` raises.
    """
    split = "test" if "test" in jury.shots else "val"
    shots = jury.shots[split]
    notes: list[str] = []
    candidates = [c for entrant in columns for c in _candidates(entrant, sorted(set(counts)), jury.footage, notes)]
    records: dict[str, Sequence[Record]] = {}
    for candidate in candidates:
        label = candidate.variant.label
        records[label] = jury.records(label, candidate.identity, candidate.opens, [split])[split]
    gallery = gallery_of(jury.footage, shots, records[candidates[0].variant.label])
    for candidate in candidates:
        label = candidate.variant.label
        show(gallery, label, candidate.opens(jury.footage), jury.footage, shots, records[label])
    variants = [candidate.variant for candidate in candidates]
    jury.bar.begin("timing", None)
    frames = {candidate.variant.label: candidate.frame(jury.footage) for candidate in candidates}
    figures = sizes_json(split, shots, variants, records, _paced(frames, shots[0].camera), notes)
    return Sizes(figures, gallery, sizes_said(figures))


def _candidates(entrant: Entrant, counts: Sequence[int], footage: Capture, notes: list[str]) -> list[_Candidate]:
    column = entrant.column
    if is_run(entrant.path):
        return [_run(entrant, footage)]
    gem = open_avatar(entrant.path).gem
    found = []
    for used in counts:
        if used > gem.components:
            notes.append(f"{column.name} stores {gem.components} components: it has no row with {used}.")
            continue
        label = f"{column.name}, {used} components"
        fewer = gem.truncated(used)
        variant = Variant(label, column.name, column.kind, gem.uv_size, len(gem), used, _stored(fewer))
        if used == gem.components:  # it was judged so already
            identity, opens = column.sha256, entrant.opened
        else:
            identity, opens = f"{column.sha256}, {used} components", partial(_fewer, entrant.path, used)
        found.append(_Candidate(variant, identity, opens, partial(_expressions, fewer)))
    return found


def _fewer(path: Path, components: int, capture: Capture) -> "Contestant":
    from ...models.train.judging.contestants import GemContestant

    return GemContestant(open_avatar(path).gem.truncated(components), capture)


def _stored(gem: Gem) -> dict[str, float]:
    """Megabytes of its file, really written."""
    sizes = {}
    with tempfile.TemporaryDirectory() as folder:
        for form in ("int8", "fp16"):
            path = Path(folder) / f"{form}.gem"
            save_gem(gem, path, form)
            sizes[form] = path.stat().st_size / 1e6
    return sizes


def _expressions(gem: Gem, capture: Capture) -> Frame:
    """Composes random expressions, as ``gemheads bench`` does."""
    del capture
    rng = np.random.default_rng(1)
    splats = gem.compose(gem.rest_coefficients)
    drawn = gem.rest_coefficients + rng.standard_normal((ROUNDS, gem.coefficient_count)) * gem.sigma
    turn = count()
    coefficients = gem.clamped(drawn)
    return lambda: gem.compose(coefficients[next(turn) % ROUNDS], out=splats)


def _run(entrant: Entrant, footage: Capture) -> _Candidate:
    """A run: what it learned, and its answer to what was tracked."""
    from ...models.train.avatars.runs import open_run

    column = entrant.column
    run = open_run(entrant.path, footage.folder)
    weights = sum(tensor.numel() * tensor.element_size() for tensor in run.avatar.state_dict().values())

    def frame(capture: Capture) -> Frame:
        meshes = [capture.tracked(timestep) for timestep in capture.timesteps("train")[:ROUNDS]]
        turn = count()
        return lambda: run.splats(meshes[next(turn) % len(meshes)])

    stored = {"fp32": weights / 1e6}
    variant = Variant(column.name, column.name, column.kind, run.plan.size, column.splats, None, stored)
    return _Candidate(variant, column.sha256, entrant.opened, frame)


def _paced(frames: Mapping[str, Frame], camera: Camera) -> Pace:
    """Times all in turns, by the engine that is fastest here."""
    engine = open_engine("auto")
    try:
        for _ in range(WARM):
            for frame in frames.values():
                engine.draw(frame(), camera)
        spent: dict[str, list[float]] = {label: [] for label in frames}
        used: list[str] = []
        started, rounds = time.perf_counter(), 0
        while rounds < ROUNDS and (rounds < 3 or time.perf_counter() - started < PATIENCE):
            rounds += 1
            for label, frame in frames.items():
                spent[label].append(_seconds(engine, frame, camera))
                used.append(engine.name)
        medians = {label: 1000 * median(times) for label, times in spent.items()}
        return Pace("/".join(dict.fromkeys(used)), engine.description, camera.width, camera.height, rounds, medians)
    finally:
        engine.close()


def _seconds(engine: Engine, frame: Frame, camera: Camera) -> float:
    began = time.perf_counter()
    engine.draw(frame(), camera)
    return time.perf_counter() - began
