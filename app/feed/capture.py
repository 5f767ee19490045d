"""The capture thread: from a source to the newest shot. The window asks, and never waits."""

import threading
import time
from collections.abc import Callable
from math import inf

import numpy as np

from ...models.driver.face import FaceTracker
from ...models.driver.features import DIMENSION
from ...models.driver.neutral import NeutralChoice
from ..inputs.source import Opener, Transport
from ..performing.casting import Avatar
from ..performing.shots import Health, Shot
from ..person.following import Tracker
from ..person.tuning import Tuning
from .loop import Loop

__all__ = ["Capture", "Tuning"]

FAREWELL_SECS = 0.7
"""How long closing waits for the thread; one that hangs longer ends with the program."""


def glancing() -> FaceTracker:
    """Looks once at each picture: looking twice at faces that move, a window on two cores falls behind its camera."""
    return FaceTracker(moved=inf)


class Capture:
    """Every method is for the window thread and returns at once. Use it as a context, or call ``close``."""

    def __init__(
        self,
        avatar: Avatar,
        tracker: Callable[[], Tracker] = glancing,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Starts the thread, without a source. Raises InputError when the avatar's regressor is broken."""
        self._loop = Loop(avatar, tracker, clock)
        self._chosen = Health()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="capture", daemon=True)
        self._thread.start()

    def __enter__(self) -> "Capture":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def use(self, opener: Opener | None, name: str = "") -> None:
        """Open another source, called ``name`` until it is open; None for none. The neutral is found anew."""
        serial = self._chosen.serial + 1
        self._chosen = Health("opening" if opener else "no source", source=name, serial=serial)
        self._loop.ask(lambda: self._loop.use(opener, name, serial))

    def cast(self, avatar: Avatar) -> None:
        """Another avatar; its shot of the present moment comes at once."""
        self._loop.ask(lambda: self._loop.cast(avatar))

    def tune(self, tuning: Tuning) -> None:
        """Other positions of the sliders."""
        self._ask_and_show(lambda: self._loop.acting.tune(tuning))

    def rest(self, neutral: NeutralChoice | None) -> None:
        """The neutral that counts from now on; None: it is looked for anew. Raises ValueError for one that is none."""
        if neutral is not None and not _is_usable(neutral):
            raise ValueError(f"no neutral: {neutral.features.shape} features, expected {DIMENSION} finite ones")
        self._ask_and_show(lambda: self._loop.acting.rest(neutral))

    def relock(self) -> None:
        """Follow the next face, to the right of the followed one."""
        self._loop.ask(self._loop.acting.relock)

    @property
    def transport(self) -> Transport | None:
        """The buttons of the source; None where it has none, or is not open."""
        link = self._loop.link if self._loop.serial == self._chosen.serial else None
        source = link.source if link else None
        return source.transport if source else None

    def newest(self) -> Shot | None:
        """The newest shot, each only once."""
        return self._loop.shots.take()

    def rouse(self, waker: Callable[[], None]) -> None:
        """Have ``waker`` called whenever there is a new shot: in the capture thread, so it must return at once."""
        self._loop.shots.rouse = waker

    @property
    def health(self) -> Health:
        """How the source that was asked for last is doing; never how the one before it did."""
        health = self._loop.health
        return health if health.serial == self._chosen.serial else self._chosen

    def close(self) -> None:
        """End the thread and let go of the source, within FAREWELL_SECS from any state."""
        self._closing.set()
        self._loop.ask(lambda: None)
        self._thread.join(FAREWELL_SECS)

    def _ask_and_show(self, wish: Callable[[], None]) -> None:
        self._loop.ask(wish)
        self._loop.ask(self._loop.changed)

    def _run(self) -> None:
        try:
            while not self._closing.is_set():
                self._loop.turn()
        finally:
            self._loop.close()


def _is_usable(neutral: NeutralChoice) -> bool:
    values = np.concatenate([np.ravel(neutral.features), np.ravel(neutral.rotation)])
    return neutral.features.shape == (DIMENSION,) and neutral.rotation.shape == (3,) and bool(np.isfinite(values).all())
