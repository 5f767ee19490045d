"""A camera made of the demo clip: a face at 640x480 and 30 frames a second whose every frame carries its number."""

import time
from collections.abc import Callable
from fractions import Fraction

import cv2
import numpy as np
from numpy.typing import NDArray

from ..files.video import VideoFile
from ..inputs.source import Kind, TimedFrame
from ..library import DEMO_CLIP
from .stamp import stamp

RATE = 30
WIDTH, HEIGHT = 640, 480
KEPT = 90
"""Frames held in memory (83 MB), so that no decoding is measured that a camera would not need."""


class StampedCamera:
    """Delivers frame n at the n-th thirtieth of a second, whether anybody looks or not."""

    name = f"bench camera, {WIDTH}x{HEIGHT} at {RATE}"
    kind: Kind = "camera"
    transport = None
    rejected = 0

    def __init__(self, pictures: list[NDArray[np.uint8]], clock: Callable[[], float] = time.perf_counter) -> None:
        """``pictures``: at least one, [H, W, 3]; they are played forwards and backwards."""
        self._pictures, self._clock = pictures, clock
        self._start = clock()
        self._last = -1
        self.drops = 0
        """Frames that a newer one replaced before they were read."""

    def delivered(self, number: int) -> float:
        """When a frame was delivered, seconds of the clock."""
        return self._start + number / RATE

    def read(self, timeout: float) -> TimedFrame | None:
        """The newest frame, once; None when none is due within ``timeout`` seconds."""
        number = self._due()
        if number == self._last:
            time.sleep(max(0.0, min(timeout, self.delivered(number + 1) - self._clock())))
            number = self._due()
        if number == self._last:
            return None
        self.drops += number - self._last - 1
        self._last = number
        there_and_back = [*range(len(self._pictures)), *range(len(self._pictures) - 2, 0, -1)]
        picture = self._pictures[there_and_back[number % len(there_and_back)]].copy()
        stamp(picture, number)
        return TimedFrame(picture, number, Fraction(1, RATE), delivered=self.delivered(number))

    def close(self) -> None:
        """Nothing is held."""

    def _due(self) -> int:
        return int((self._clock() - self._start) * RATE)


def demo_pictures(count: int = KEPT) -> list[NDArray[np.uint8]]:
    """The first frames of the demo clip in the middle of pictures [HEIGHT, WIDTH, 3]. Raises InputError."""
    pictures = []
    for frame in VideoFile(DEMO_CLIP).frames():
        inner = cv2.resize(frame.rgb, (HEIGHT, HEIGHT), interpolation=cv2.INTER_AREA)
        side = (WIDTH - HEIGHT) // 2
        framed = cv2.copyMakeBorder(inner, 0, 0, side, side, cv2.BORDER_REPLICATE)
        pictures.append(framed.astype(np.uint8, copy=False))
        if len(pictures) == count:
            break
    return pictures
