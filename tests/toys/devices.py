"""A camera for OpenCV that is none."""

import threading
import time
from collections.abc import Callable

import numpy as np


class Device:
    """Gives what ``picture`` makes; ``None`` is a failed read."""

    def __init__(self, picture: Callable[[], object], opened: bool = True) -> None:
        self.picture, self.opened = picture, opened
        self.asked: dict[int, float] = {}
        self.released = threading.Event()

    def isOpened(self) -> bool:
        return self.opened

    def set(self, what: int, value: float) -> bool:
        self.asked[what] = value
        return True

    def read(self) -> tuple[bool, object]:
        time.sleep(0.002)
        image = self.picture()
        return image is not None, image

    def release(self) -> None:
        self.released.set()


def blue() -> np.ndarray:
    """A picture as OpenCV has them: blue, green, red."""
    return np.tile(np.array([200, 0, 0], np.uint8), (48, 64, 1))
