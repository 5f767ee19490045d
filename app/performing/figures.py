"""Rolling figures of a live session: pictures a second, latency, milliseconds by stage, drops and memory.

Every figure lives in a ring of fixed size: a session that runs for a day takes no more memory than one of a minute.
"""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

WINDOW = 240
"""Frames that a figure looks back on: 4 to 8 seconds."""
MEMORY_SECS = 1.0
"""How often the memory is looked up."""


@dataclass(frozen=True)
class Spread:
    """Of the last frames, in milliseconds."""

    median: float
    p95: float


@dataclass(frozen=True)
class View:
    """The figures at one moment."""

    fps: float
    """Pictures shown a second."""
    latency: Spread | None
    """From a frame delivered by the source to its picture swapped; None before the first."""
    stages: Mapping[str, Spread]
    """By stage, in the order of their first visits."""
    drops: int
    """Frames of the source that nobody looked at."""
    rss_mb: float
    """Memory of this process."""


class Ring:
    """The last numbers, at most WINDOW of them."""

    def __init__(self, size: int = WINDOW) -> None:
        self._values: NDArray[np.float64] = np.zeros(size)
        self.count = 0
        """How many there ever were."""

    def add(self, value: float) -> None:
        """One more; the oldest goes."""
        self._values[self.count % len(self._values)] = value
        self.count += 1

    @property
    def values(self) -> NDArray[np.float64]:
        """What is in it, in no order."""
        return self._values[: self.count]

    def spread(self, unit: float = 1e3) -> Spread:
        """Median and 95th percentile, times ``unit``; zeros when it is empty."""
        if not self.count:
            return Spread(0.0, 0.0)
        median, p95 = np.quantile(self.values, (0.5, 0.95)) * unit
        return Spread(float(median), float(p95))


class Figures:
    """Collects on the window's thread; ``stage`` may be told from another one, too."""

    def __init__(self) -> None:
        import psutil

        self._process = psutil.Process()
        self._shown, self._latency = Ring(), Ring()
        self._stages: dict[str, Ring] = {}
        self._rss, self._rss_at = 0.0, -MEMORY_SECS
        self.drops = 0
        """Frames of the source that nobody looked at: the source counts them."""

    def stage(self, name: str, secs: float) -> None:
        """A visit to a stage took so long."""
        if name not in self._stages:
            self._stages[name] = Ring()
        self._stages[name].add(secs)

    @contextmanager
    def timed(self, name: str) -> Iterator[None]:
        """Times one visit to a stage."""
        started = time.perf_counter()
        try:
            yield
        finally:
            self.stage(name, time.perf_counter() - started)

    def shown(self, now: float, delivered: float | None) -> None:
        """A picture was swapped at ``now``; ``delivered``: when the frame came that is seen for the first time in it,
        None when it shows nothing new. Seconds of ``time.perf_counter``."""
        self._shown.add(now)
        if delivered is not None:
            self._latency.add(now - delivered)

    def view(self, now: float) -> View:
        """The figures as they are at ``now``."""
        if now - self._rss_at >= MEMORY_SECS:
            self._rss, self._rss_at = self._process.memory_info().rss / 1e6, now
        recent = self._shown.values[self._shown.values > now - 2.0]
        span = float(np.ptp(recent)) if len(recent) > 1 else 0.0
        return View(
            fps=(len(recent) - 1) / span if span > 0 else 0.0,
            latency=self._latency.spread() if self._latency.count else None,
            stages={name: ring.spread() for name, ring in tuple(self._stages.items())},
            drops=self.drops,
            rss_mb=self._rss,
        )
