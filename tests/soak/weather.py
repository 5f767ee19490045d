"""A camera, a tracker and an engine to which everything happens that happens to such things, at random."""

import time
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any, Literal, get_args

import numpy as np
from gemheads.app.bench.source import RATE
from gemheads.app.inputs.source import SourceLost, TimedFrame
from gemheads.models.driver.face import FaceObservation, FaceTracker
from gemheads.models.driver.networks import NetworkError
from gemheads.render.camera import Camera
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from numpy.typing import NDArray

Weather = Literal[
    "fair", "frozen", "silent", "gone", "refused", "garbage", "resized", "crash", "nan", "no network", "no memory"
]
FAIR_SECS, FOUL_SECS = (1.0, 6.0), (0.3, 3.0)
GARBAGE: tuple[Any, ...] = (
    *(None, "text", np.zeros((0, 0, 3), np.uint8), np.zeros((48, 64), np.uint8)),
    *(np.zeros((48, 64, 3)), np.full((48, 64, 3), np.nan)),
)


class Sky:
    """What the weather is; fair and foul take turns, each for a random time."""

    def __init__(self, rng: Random, clock: Callable[[], float] = time.perf_counter) -> None:
        self._rng, self._clock = rng, clock
        self._now: Weather = "fair"
        self._foul: list[Weather] = []
        self._until = clock() + FAIR_SECS[1]
        self.seen: dict[Weather, int] = dict.fromkeys(get_args(Weather), 0)
        """How often each came."""

    @property
    def now(self) -> Weather:
        """The weather of this moment."""
        if self._clock() >= self._until:
            self._now = self._next() if self._now == "fair" else "fair"
            self._until = self._clock() + self._rng.uniform(*(FAIR_SECS if self._now == "fair" else FOUL_SECS))
            self.seen[self._now] += 1
        return self._now

    def clear(self) -> None:
        """Fair from now on."""
        self._now, self._until = "fair", float("inf")

    def _next(self) -> Weather:
        """Each kind once before any comes again."""
        if not self._foul:
            self._foul = [weather for weather in get_args(Weather) if weather != "fair"]
            self._rng.shuffle(self._foul)
        return self._foul.pop()


class RoughCamera:
    """Delivers pictures at 30 a second, as far as the weather allows."""

    kind = "camera"
    transport = None
    name = "rough camera"

    def __init__(self, pictures: list[NDArray[np.uint8]], sky: Sky) -> None:
        """Raises SourceLost in weather in which no camera opens."""
        if sky.now in ("gone", "refused"):
            raise SourceLost("It is not connected.", "Plug it in.", True)
        self._pictures, self._sky = pictures, sky
        self._number = round(time.perf_counter() * RATE)
        self.drops = self.rejected = 0

    def read(self, timeout: float) -> Any:
        """The next picture, or what comes instead."""
        wait = (self._number + 1) / RATE - time.perf_counter()
        time.sleep(max(0.0, min(timeout, wait)))
        number = int(time.perf_counter() * RATE)
        weather = self._sky.now
        if weather == "gone":
            raise SourceLost("It went away.", "Plug it in again.", True)
        if weather == "crash":
            raise ZeroDivisionError("a driver's own")
        if number == self._number or weather == "silent":
            return None
        self._number = number
        shown = 0 if weather == "frozen" else number
        rgb = self._pictures[shown % len(self._pictures)]
        if weather == "garbage":
            rgb = GARBAGE[number % len(GARBAGE)]
        elif weather == "resized":
            rgb = np.ascontiguousarray(rgb[:: 1 + number // 20 % 2, :: 1 + number // 20 % 2])
        return TimedFrame(rgb, number, Fraction(1, RATE), delivered=number / RATE)

    def close(self) -> None:
        """Nothing is held."""


class RoughTracker(FaceTracker):
    """The real tracker; in foul weather it fails, or sees numbers that are none."""

    def __init__(self, sky: Sky) -> None:
        super().__init__()
        self._sky = sky

    def track(self, rgb: NDArray[np.uint8], *arguments: Any) -> FaceObservation | None:
        """As FaceTracker's."""
        weather = self._sky.now
        if weather == "no network":
            raise NetworkError("a network is missing")
        if weather == "no memory":
            raise MemoryError
        face = super().track(rgb, *arguments)
        if face is not None and weather == "nan":
            return replace(face, scores=np.full_like(face.scores, np.nan))
        return face


class DyingEngine(SoftwareEngine):
    """Stands for a GL driver that crashes after so many frames."""

    name = "quads"

    def __init__(self, frames: int) -> None:
        super().__init__()
        self._left = frames

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]:
        """As SoftwareEngine's, as long as it lives."""
        self._left -= 1
        if self._left < 0:
            raise RuntimeError("the GL context is lost")
        return super().draw(raw, camera)
