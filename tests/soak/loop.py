"""The live loop without its panels: the real capture thread, tracker, drawing and recording, watched all the while."""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

import psutil
from gemheads.app.bench.source import demo_pictures
from gemheads.app.feed.capture import Capture
from gemheads.app.library import find_avatar
from gemheads.app.live import Stage, draw
from gemheads.app.performing.casting import open_avatar
from gemheads.app.performing.portrait import portrait
from gemheads.app.performing.timing import Stopwatch
from gemheads.app.senders.fan import Fan
from gemheads.app.senders.recording import Recording
from gemheads.render.engines import FastestEngine
from gemheads.render.software import SoftwareEngine

from .weather import DyingEngine, RoughCamera, RoughTracker, Sky, Weather

SIZE = (256, 256)
RECORDING_SECS = 4.0
ENGINE_FRAMES = 200
"""An engine lives for up to so many frames; then another one is opened, as after a change of the window."""


@dataclass
class Soaked:
    """What was seen."""

    seconds: float = 0.0
    pictures: int = 0
    gaps: list[float] = field(default_factory=list)
    """Seconds between two pictures, after the warm-up ..."""
    stalls: list[float] = field(default_factory=list)
    """... and without those in which a thread of the program waited for a core."""
    rss: list[float] = field(default_factory=list)
    """Megabytes, twice a second."""
    handles: list[int] = field(default_factory=list)
    threads: list[int] = field(default_factory=list)
    weather: dict[Weather, int] = field(default_factory=dict)
    engines_lost: int = 0
    recordings: int = 0
    failures: list[str] = field(default_factory=list)
    """Exceptions that ended a thread, recordings that failed, and what else must not be."""
    alive: bool = False
    """Whether the capture thread was there at the end, and tracked again in fair weather."""


def soak(seconds: float, folder: Path, seed: int = 0, warm_up: float = 5.0) -> Soaked:
    """Run for so long; recordings go to ``folder`` and are deleted. Raises InputError without the shipped files."""
    rng, soaked = Random(seed), Soaked()
    sky = Sky(rng)
    pictures = demo_pictures(30)
    avatar = open_avatar(find_avatar())
    before, threading.excepthook = threading.excepthook, lambda hooked: soaked.failures.append(repr(hooked.exc_value))
    engine = _engine(rng)
    stage = Stage(avatar.gem, engine, portrait(avatar.gem.viewing, *SIZE), (0.5, 0.5, 0.5), Stopwatch(), 5)
    fan = Fan()
    try:
        with Capture(avatar, lambda: RoughTracker(sky)) as capture:
            capture.use(lambda: RoughCamera(pictures, sky), RoughCamera.name)
            watch = _Watch(soaked, warm_up)
            recording_until = 0.0
            while watch.elapsed < seconds:
                shot = capture.newest()
                if shot is None:
                    time.sleep(0.002)
                    continue
                fan.offer(draw(stage, shot.pose), time.perf_counter(), shot.pose, shot.avatar)
                watch.drawn()
                if engine.description.endswith("(quads failed: the GL context is lost)"):
                    engine.close()
                    engine = _engine(rng)
                    stage = Stage(avatar.gem, engine, stage.camera, stage.background, Stopwatch(), 5)
                    soaked.engines_lost += 1
                if time.perf_counter() > recording_until:
                    _next_recording(fan, soaked, folder)
                    recording_until = time.perf_counter() + rng.uniform(1, RECORDING_SECS)
            sky.clear()
            soaked.alive = _until(lambda: capture.health.phase == "tracking", 15) and capture._thread.is_alive()
        if not fan.close(10):
            soaked.failures.append("an output did not end")
    finally:
        engine.close()
        threading.excepthook = before
    soaked.seconds, soaked.weather = seconds, sky.seen
    return soaked


class _Watch:
    """Looks at the process while it runs."""

    def __init__(self, soaked: Soaked, warm_up: float) -> None:
        self._soaked, self._warm_up = soaked, warm_up
        self._process, self._started = psutil.Process(), time.perf_counter()
        self._drawn_at = self._looked = 0.0
        self._waited = waited()

    @property
    def elapsed(self) -> float:
        return time.perf_counter() - self._started

    def drawn(self) -> None:
        """A picture is done."""
        now, soaked = self.elapsed, self._soaked
        before, self._waited = self._waited, waited()
        if now >= self._warm_up:
            soaked.pictures += 1
            if self._drawn_at >= self._warm_up:
                gap = now - self._drawn_at
                starved = sum(secs - before.get(thread, 0.0) for thread, secs in self._waited.items())
                soaked.gaps.append(gap)
                soaked.stalls.append(max(0.0, gap - starved))
            if now - self._looked >= 0.5:
                self._looked = now
                soaked.rss.append(self._process.memory_info().rss / 1e6)
                soaked.handles.append(self._process.num_fds() if hasattr(self._process, "num_fds") else 0)
                soaked.threads.append(threading.active_count())
        self._drawn_at = now


def waited() -> dict[str, float]:
    """Thread -> seconds that it was ready and had no core, so far; empty where the system does not say."""
    found = {}
    for file in Path("/proc/self/task").glob("*/schedstat"):
        with suppress(OSError):  # it ended meanwhile
            found[file.parent.name] = int(file.read_text().split()[1]) / 1e9
    return found


def _engine(rng: Random) -> FastestEngine:
    FastestEngine._decided = "quads"  # so that its death is noticed
    return FastestEngine(DyingEngine(rng.randint(1, ENGINE_FRAMES)), SoftwareEngine())


def _next_recording(fan: Fan, soaked: Soaked, folder: Path) -> None:
    """End the recording that runs, look at the last one, and begin another."""
    if fan.running("recording"):
        fan.stop("recording")
        return
    for report in fan.reports():
        if report.phase == "failed":
            soaked.failures.append(report.text)
    for old in folder.glob("*.mp4"):
        old.unlink()
    soaked.recordings += 1
    path = folder / f"{soaked.recordings}.mp4"
    fan.start("recording", lambda: Recording(path, SIZE, 30), depth=8)


def _until(done: Callable[[], bool], seconds: float) -> bool:
    end = time.perf_counter() + seconds
    while not done() and time.perf_counter() < end:
        time.sleep(0.05)
    return done()
