"""A face tracker that opens its networks when the first picture comes: tracks and OSC need none."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ...models.driver.detector import Detection
from ...models.driver.face import Box, FaceObservation
from .following import Tracker


class LazyTracker:
    """Forwards to the tracker that ``make`` makes; what that raises, every use raises again."""

    def __init__(self, make: Callable[[], Tracker]) -> None:
        self._make = make
        self._made: Tracker | None = None
        self._error: Exception | None = None

    def track(self, rgb: NDArray[np.uint8], locked: Box | None = None) -> FaceObservation | None:
        """The followed face in [H, W, 3] of RGB bytes, None without one."""
        return self._there().track(rgb, locked)

    def detect(self, rgb: NDArray[np.uint8]) -> list[Detection]:
        """All faces, the surest first."""
        return self._there().detect(rgb)

    def lock(self, face: Detection) -> None:
        """Follow this one from the next image on."""
        self._there().lock(face)

    def reset(self) -> None:
        """Forget the face."""
        if self._made is not None:
            self._made.reset()

    def _there(self) -> Tracker:
        if self._error is not None:
            raise self._error
        if self._made is None:
            try:
                self._made = self._make()
            except Exception as error:
                self._error = error
                raise
        return self._made
