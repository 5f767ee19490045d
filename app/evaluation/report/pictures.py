"""The pictures of the report: which are shown, small enough for a page, and packed into its text."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np

from ....render.arrays import Image

STRIP = 8
"""Pictures in a film strip."""
STRIP_HEIGHT = 150
"""Of one of them, pixels at most."""
CELL_SIDE = 360
"""Longer side of a picture beside its error, pixels at most."""
QUALITY = 90
"""Of JPEG."""


@dataclass(frozen=True)
class Choice:
    """Which pictures of a split are shown, by their place in the list."""

    compared: dict[str, int]
    """In what respect -> the picture beside its error."""
    strip: tuple[int, ...]

    @property
    def all(self) -> set[int]:
        """Either."""
        return {*self.compared.values(), *self.strip}


@dataclass
class Gallery:
    """Packed pictures of one split; rows are called by the avatar, "" is what was taken."""

    choice: Choice
    drawn: dict[tuple[str, int], str] = field(default_factory=dict)
    """Row and place of a compared picture -> data URL."""
    errors: dict[tuple[str, int], str] = field(default_factory=dict)
    strips: dict[str, str] = field(default_factory=dict)
    """Row -> data URL of its film strip."""
    _frames: list[Image] = field(default_factory=list)

    def add(self, row: str, place: int, image: Image, error: Image | None) -> None:
        """A picture [H, W, 3] and where it differs from the one taken; of a row, in the order of places."""
        if place in self.choice.compared.values():
            self.drawn[row, place] = data_url(shrunk(image, CELL_SIDE))
            if error is not None:
                self.errors[row, place] = data_url(shrunk(error, CELL_SIDE))
        if place in self.choice.strip:
            self._frames.append(shrunk(image, STRIP_HEIGHT))

    def end_row(self, row: str) -> None:
        """All pictures of a row have been added."""
        height = max((len(frame) for frame in self._frames), default=0)
        padded = [
            np.pad(frame, ((0, height - len(frame)), (0, 0), (0, 0)), constant_values=255) for frame in self._frames
        ]
        if padded:
            self.strips[row] = data_url(np.concatenate(padded, 1))
        self._frames.clear()


def choose(quality: Sequence[float]) -> Choice:
    """The worst, the median and the best picture by ``quality`` (larger is better), and STRIP spread over all."""
    order = np.argsort(np.asarray(quality, np.float64), kind="stable")
    compared: dict[str, int] = {}
    for word, rank in (("worst", 0), ("median", len(order) // 2), ("best", len(order) - 1)):
        if len(order) and int(order[rank]) not in compared.values():
            compared[word] = int(order[rank])
    count = min(STRIP, len(order))
    return Choice(compared, tuple(int((part + 0.5) * len(order) / count) for part in range(count)))


def shrunk(image: Image, longest: int) -> Image:
    """No side longer than ``longest``, the shape kept."""
    height, width = image.shape[:2]
    scale = longest / max(height, width)
    if scale >= 1:
        return image
    size = max(1, round(width * scale)), max(1, round(height * scale))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def data_url(image: Image) -> str:
    """sRGB [H, W, 3] as the text of a JPEG that a page can hold."""
    packed = cv2.imencode(".jpg", np.ascontiguousarray(image[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
    return "data:image/jpeg;base64," + base64.b64encode(packed.tobytes()).decode("ascii")
