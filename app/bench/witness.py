"""Stands between the live loop and its window, its engine and its capture, and sees what arrives on the screen."""

import time
from typing import Protocol

import numpy as np
import psutil
from numpy.typing import NDArray

from ...render.camera import Camera
from ...render.engines import Engine
from ...render.gaussians import RawGaussians
from ..desk.actions import Order
from ..desk.layout import laid_out
from ..desk.view import DeskView
from ..feed.capture import Capture
from ..inputs.source import Opener
from ..live import Desk
from ..performing.casting import Avatar
from ..performing.figures import Ring
from ..performing.shots import Shot
from .screen import Reader
from .source import RATE, StampedCamera
from .stamp import NUMBERS, cell_centres, read, stamp
from .steal import Steal

PATIENCE = 20
"""A measurement in which nothing new was to be seen goes on, for so many times as long as was asked for."""
SEEN_WITHIN = 20
"""Milliseconds that a picture may take from the swap to the screen."""
MOST = 100_000
"""Figures kept: half an hour and more."""


class Window(Desk, Protocol):
    """A desk that can be measured."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in screen units."""
        ...


class BenchCapture(Capture):
    """The real capture thread, at the bench's camera whatever is asked for."""

    def __init__(self, avatar: Avatar, camera: StampedCamera) -> None:
        self._camera, self.taken = camera, 0
        """``taken``: number of the frame that the newest shot shows."""
        self.stages: dict[str, Ring] = {}
        super().__init__(avatar)

    def use(self, opener: Opener | None, name: str = "") -> None:
        """The bench's camera."""
        super().use(lambda: self._camera, self._camera.name)

    def newest(self) -> Shot | None:
        """The newest shot; remembers which frame it comes from."""
        shot = super().newest()
        if shot is not None:
            self.taken = round(shot.source_secs * RATE)
            for name, secs in shot.stages.items():
                self.stages.setdefault(name, Ring(MOST)).add(secs)
        return shot


class StampingEngine:
    """Draws with another engine, and puts into each picture the number of the frame that it shows."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self.capture: BenchCapture | None = None

    @property
    def name(self) -> str:
        """Of the engine that draws."""
        return self._engine.name

    @property
    def description(self) -> str:
        """Of the engine that draws."""
        return self._engine.description

    @property
    def timings(self) -> dict[str, float]:
        """Of the engine that draws."""
        return self._engine.timings

    @property
    def bound(self) -> bool:
        """As the engine that draws is."""
        return self._engine.bound

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]:
        """The engine's picture with a stamp on it: the capture gives no newer frame while one is drawn."""
        picture = self._engine.draw(raw, camera)
        if self.capture is not None:
            picture = picture if picture.flags.writeable else picture.copy()
            stamp(picture, self.capture.taken)
        return picture

    def close(self) -> None:
        """Close the engine that draws."""
        self._engine.close()


class Witness:
    """A window that reads from its own pixels which frame of the camera is to be seen, and when."""

    def __init__(self, desk: Window, reader: Reader, camera: StampedCamera, warm_up: float, seconds: float) -> None:
        """Measures ``seconds`` from ``warm_up`` seconds after the first picture on, then asks the loop to quit."""
        self._desk, self._reader, self._camera = desk, reader, camera
        self._warm_up, self._seconds = warm_up, seconds
        self._first: float | None = None
        self._number: int | None = None
        self._process = psutil.Process()
        self.latencies, self.shows, self.frames = Ring(MOST), Ring(MOST), Ring(MOST)
        self.unread = self.skipped = 0
        """Pictures whose stamp could not be read; frames of the camera that were never to be seen."""
        self.began: float | None = None
        self.ended = self.processor = self._processor_before = 0.0
        """``processor``: seconds of all cores since it began."""
        self.stolen: float | None = None
        """Percent of all cores' time that the host gave to others since it began, where the system says."""
        self._steal = Steal()
        self.rss: list[tuple[float, float]] = []
        """Seconds and MB, once a second."""

    def wake(self) -> None:
        """As the window's."""
        self._desk.wake()

    def clean(self, picture: NDArray[np.uint8] | None) -> bool:
        """As the window's."""
        return self._desk.clean(picture)

    @property
    def measuring(self) -> bool:
        """Whether the warm-up is over."""
        return self.began is not None

    def poll(self, wait: float = 0.0) -> list[Order]:
        """The window's orders, and at the end the one to quit."""
        now = time.perf_counter()
        if self.began is None and self._first is not None and now - self._first >= self._warm_up:
            self.began, self._processor_before, self._steal = now, time.process_time(), Steal()
        if self.began is not None:
            self.ended, self.processor = now, time.process_time() - self._processor_before
            self.stolen = self._steal.percent()
            if not self.rss or now - self.rss[-1][0] >= 1.0:
                self.rss.append((now, self._process.memory_info().rss / 1e6))
            if now - self.began >= self._seconds * (1 if self.frames.count else PATIENCE):
                return [Order("quit")]
        return self._desk.poll(wait)

    def show(self, picture: NDArray[np.uint8] | None, view: DeskView) -> None:
        """Show it, and look which frame is to be seen now."""
        started = time.perf_counter()
        self._desk.show(picture, view)
        if self.measuring:
            self.shows.add(time.perf_counter() - started)
        if picture is None:
            return
        wanted = read(_stamp_in(picture))
        number = self._seen(picture, view, wanted)
        now = time.perf_counter()
        if wanted is None or number is None:
            self.unread += self.measuring
            return
        self._first = self._first or now
        if self._number is not None:
            number = self._number + (number - self._number) % NUMBERS
            if number == self._number:
                return
            if self.measuring:
                self.skipped += number - self._number - 1
        self._number = number
        if self.measuring:
            self.latencies.add(now - self._camera.delivered(number))
            self.frames.add(now)

    def _seen(self, picture: NDArray[np.uint8], view: DeskView, wanted: int | None) -> int | None:
        """The number on the screen, as soon as it is the wanted one."""
        width, height = self._desk.size
        area = laid_out(view, width, height).picture.fitted(picture.shape[1], picture.shape[0])
        columns, row = cell_centres(area.left, area.top, area.width, view.state.mirror)
        for _ in range(SEEN_WITHIN):
            lumas = self._reader.row(columns, row)
            number = None if lumas is None else read(lumas)
            if number is not None and number == wanted:
                return number
            time.sleep(0.001)
        return None


def _stamp_in(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    columns, row = cell_centres(0, 0, picture.shape[1])
    return picture[row, columns, 1]
