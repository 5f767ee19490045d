"""How fast a session goes, and what the quality ladder makes of it."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from ..performing.figures import Figures, Spread
from ..performing.ladder import Ladder, Quality, quality, update
from ..performing.shots import Health, Shot
from .view import Readings

READ_EVERY = 0.25
"""Seconds between two readings: they are to be read."""
LONGEST_DT = 0.5
"""A longer gap between frames was no work: the window was moved, or the machine slept; unless frames themselves take so
long, one after the other."""


class Gauges:
    """Collects in the window's thread; stages are timed where they happen."""

    def __init__(self) -> None:
        self._figures = Figures()
        self._ladder = Ladder()
        self._frame_at = self._read_at = float("-inf")
        self._crawled = False
        self._readings = Readings()

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        """Time one visit to ``stage``."""
        with self._figures.timed(stage):
            yield

    def stages(self, now: float) -> Mapping[str, Spread]:
        """Stage -> milliseconds of the last visits to it."""
        return self._figures.view(now).stages

    def quality(self, components: int) -> Quality:
        """What to draw of what the person wants, as far as the machine allows."""
        return quality(self._ladder, Quality(components))

    def shown(self, shot: Shot | None, worked: float, components: int, ladder: bool, now: float) -> None:
        """A picture was swapped at ``now``.

        Args:
            shot: what is seen for the first time in it.
            worked: seconds the frame took, without waiting for the screen.
            components: as the person wants them.
            ladder: whether the ladder may act.
        """
        self._figures.shown(now, shot.delivered if shot is not None else None)
        for stage, seconds in shot.stages.items() if shot is not None else ():
            self._figures.stage(stage, seconds)
        dt, self._frame_at = now - self._frame_at, now
        crawls = dt >= LONGEST_DT > dt - worked
        if not ladder:
            self._ladder = Ladder()
        elif dt < LONGEST_DT or (crawls and self._crawled):
            self._ladder = update(self._ladder, 1e3 * worked, min(dt, LONGEST_DT), Quality(components))
        self._crawled = crawls

    def read(self, health: Health, engine: str, now: float) -> Readings:
        """The figures, a few times a second brought up to date."""
        if now - self._read_at >= READ_EVERY:
            self._read_at, self._figures.drops = now, health.drops
            figures = self._figures.view(now)
            self._readings = Readings(
                fps=figures.fps,
                stages={name: spread.median / 1e3 for name, spread in figures.stages.items()},
                latency=figures.latency.median / 1e3 if figures.latency is not None else 0.0,
                drops=figures.drops,
                megabytes=figures.rss_mb,
                engine=engine,
                provider="tracked on the processor" if "track" in figures.stages else "",
            )
        return self._readings
