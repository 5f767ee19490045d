"""Measures drawing on this machine: median milliseconds by stage, for each engine."""

import os
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

import numba
import numpy as np
from rich.console import Console
from rich.table import Table

from ...models.gem import Gem
from ...render.camera import Camera
from ...render.contexts import NoOpenGLError, offscreen_context
from ...render.engines import Engine
from ...render.gaussians import RawGaussians
from ...render.software import SoftwareEngine
from ...render.splats import SplatRenderer
from ..files.places import check_places
from ..library import find_avatar
from ..machine import cpu_name
from ..performing.casting import open_avatar
from ..performing.portrait import portrait
from ..reenacting.reports import write_json
from .steal import Steal, told
from .synthetic import synthetic_gem

SPLATS = (15_000, 60_000, 240_000)
COMPONENTS = (10, 30, 50)
SIZES = ((512, 512), (550, 802))
"""Width, height."""
STAGES = ("compose", "sort", "upload", "project", "draw", "read")
FRAMES = 9
"""Frames in a median, where they take no longer than PATIENCE."""
TABLE_WIDTH = 132
PATIENCE = 4.0
"""Seconds spent on one median, three frames at least."""


@dataclass(frozen=True)
class Measurement:
    """One scene drawn by one engine; all times are medians in milliseconds."""

    avatar: str
    splats: int
    components: int
    width: int
    height: int
    engine: str
    stages: dict[str, float]
    """Stage -> milliseconds; an engine has only the stages that it has."""
    memory_read: float
    """A plain read of the bytes that compose reads, on all cores, in between frames as compose is."""
    frame: float
    """The whole frame, compose to pixels."""
    frames_per_second: float


@dataclass(frozen=True)
class Report:
    """What was measured, and on what."""

    cpu: str
    cores: int
    engines: dict[str, str]
    """Engine -> GL renderer or threads, or why it is not here."""
    measurements: list[Measurement]
    stolen: float | None = None
    """Percent of the cores' time that the host of a virtual machine gave to others; None where the system is silent."""


def run_bench(json: Path | None = None, quick: bool = False, avatar: str | None = None) -> Report:
    """Measure, print a table, and write the figures.

    Args:
        json: where to write them as JSON too.
        quick: only the smallest scene.
        avatar: name or file of an avatar to measure besides the synthetic scenes.

    Raises CommandError.
    """
    check_places(json, read=[find_avatar(avatar)] if avatar else [])
    engines, about = _engines()
    report, steal = Report(cpu_name(), os.cpu_count() or 1, about, []), Steal()
    try:
        for gem in _scenes(quick, avatar):
            for components in COMPONENTS[:1] if quick else COMPONENTS:
                if components <= gem.components or components == COMPONENTS[0]:
                    for size in SIZES[:1] if quick else SIZES:
                        measured = _measure(gem, min(components, gem.components), portrait(gem.viewing, *size), engines)
                        report.measurements.extend(measured)
    finally:
        for engine in engines:
            engine.close()
    report = replace(report, stolen=steal.percent())
    _print(report)
    if json is not None:
        write_json(json, asdict(report))
    return report


def _engines() -> tuple[list[Engine], dict[str, str]]:
    engines: list[Engine] = [SoftwareEngine()]
    missing = {}
    try:
        quads = SplatRenderer(offscreen_context(), owns_context=True)
        quads.measures_stages = True
        engines.append(quads)
    except NoOpenGLError as error:
        missing["quads"] = str(error)
    return engines, {engine.name: engine.description for engine in engines} | missing


def _scenes(quick: bool, avatar: str | None) -> Iterator[Gem]:
    if avatar is not None:
        yield open_avatar(find_avatar(avatar)).gem
    rng = np.random.default_rng(0)
    for splats in SPLATS[:1] if quick else SPLATS:
        yield synthetic_gem(splats, (COMPONENTS[0] if quick else COMPONENTS[-1]), rng)


def _measure(gem: Gem, components: int, camera: Camera, engines: list[Engine]) -> Iterator[Measurement]:
    rng = np.random.default_rng(1)
    splats = gem.compose(gem.rest_coefficients, components)
    for engine in engines:
        _frame(gem, components, camera, engine, splats, rng)  # compiles, and touches new memory
        _read(gem, components)
        frames: list[dict[str, float]] = []
        reads: list[float] = []
        for _ in _while_patient():
            frames.append(_frame(gem, components, camera, engine, splats, rng))
            reads.append(_read(gem, components))
            engine.draw(splats, camera)  # else compose would find in the caches what was just read
        stages = {stage: 1e3 * median(frame[stage] for frame in frames) for stage in STAGES if stage in frames[0]}
        whole = 1e3 * median(frame["frame"] for frame in frames)
        yield Measurement(
            avatar=gem.name,
            splats=len(gem),
            components=components,
            width=camera.width,
            height=camera.height,
            engine=engine.name,
            stages={stage: round(value, 3) for stage, value in stages.items()},
            memory_read=round(1e3 * median(reads), 3),
            frame=round(whole, 3),
            frames_per_second=round(1e3 / whole, 1),
        )


def _frame(
    gem: Gem, components: int, camera: Camera, engine: Engine, splats: RawGaussians, rng: np.random.Generator
) -> dict[str, float]:
    """Stage -> seconds of one frame of a random expression."""
    coefficients = gem.clamped(gem.rest_coefficients + rng.standard_normal(gem.coefficient_count) * gem.sigma)
    started = time.perf_counter()
    gem.compose(coefficients, components, out=splats)
    composed = time.perf_counter()
    engine.draw(splats, camera)
    return {"compose": composed - started, **engine.timings, "frame": time.perf_counter() - started}


def _read(gem: Gem, components: int) -> float:
    """Seconds that a plain read of the numbers takes which compose reads."""
    rows = []
    for basis in gem.bases.values():
        read = basis.components if basis.moving is None else basis.moving.components
        rows += [basis.mean, read[:components].reshape(-1)]
    started = time.perf_counter()
    for row in rows:
        _sum(row)
    return time.perf_counter() - started


def _while_patient() -> Iterator[int]:
    started = time.perf_counter()
    for turn in range(FRAMES):
        if turn >= 3 and time.perf_counter() - started > PATIENCE:
            return
        yield turn


@numba.njit(cache=True, parallel=True, fastmath=True)
def _sum(values: Any) -> Any:
    total = np.float32(0)
    for i in numba.prange(len(values)):
        total += values[i]
    return total


def _print(report: Report) -> None:
    console = Console()
    console.width = max(console.width, TABLE_WIDTH)  # a table cut to 80 columns loses its figures
    console.print(f"{report.cpu}, {report.cores} cores", highlight=False)
    for name, description in report.engines.items():
        console.print(f"{name}: {description}", highlight=False)
    table = Table(title="median milliseconds", box=None)
    for heading in ("avatar", "splats", "K", "size", "engine"):
        table.add_column(heading, no_wrap=True)
    for heading in ("(read)", *STAGES, "frame", "fps"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in report.measurements:
        names = (row.avatar, f"{row.splats}", f"{row.components}", f"{row.width}x{row.height}", row.engine)
        stages = (f"{row.stages[stage]:.2f}" if stage in row.stages else "" for stage in STAGES)
        table.add_row(*names, f"{row.memory_read:.2f}", *stages, f"{row.frame:.1f}", f"{row.frames_per_second:.1f}")
    console.print(table)
    console.print("(read): a plain read of the memory that compose reads, on all cores, after a frame as compose is")
    console.print(told(report.stolen), highlight=False)
