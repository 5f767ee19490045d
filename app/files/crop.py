"""The part of a driver's pictures that is looked at: one of several people, or a face that is small in them."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import UsageError


@dataclass(frozen=True)
class Crop:
    """A rectangle of an upright picture, in shares of its width and height."""

    left: float = 0.0
    top: float = 0.0
    width: float = 1.0
    height: float = 1.0

    def __str__(self) -> str:
        if self == WHOLE:
            return "whole"
        return ",".join(f"{100 * share:g}" for share in (self.left, self.top, self.width, self.height))

    def of(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """This part of a picture [H, W, 3], contiguous."""
        rows = _pixels(self.top, self.height, rgb.shape[0])
        columns = _pixels(self.left, self.width, rgb.shape[1])
        return np.ascontiguousarray(rgb[rows, columns])


WHOLE = Crop()
_NAMED = {"whole": WHOLE, "left": Crop(width=0.5), "right": Crop(left=0.5, width=0.5)}


def read_crop(text: str) -> Crop:
    """The part named ``whole``, ``left``, ``right`` (halves) or ``X,Y,WIDTH,HEIGHT`` (percent). Raises UsageError."""
    word = text.strip().lower()
    if word in _NAMED:
        return _NAMED[word]
    number = r"\s*(\d{1,3}(?:\.\d{1,6})?)\s*"
    match = re.fullmatch(",".join([number] * 4), word)
    if not match:
        raise UsageError(f"--crop {text}: not a part; use left, right, or X,Y,WIDTH,HEIGHT in percent of the picture")
    left, top, width, height = map(float, match.groups())
    if not (width > 0 and height > 0 and left + width <= 100 and top + height <= 100):
        raise UsageError(f"--crop {text}: lies beyond the picture; X + WIDTH and Y + HEIGHT are at most 100 percent")
    return Crop(left / 100, top / 100, width / 100, height / 100)


def _pixels(begin: float, share: float, side: int) -> slice:
    first = round(begin * side)
    return slice(first, max(first, round((begin + share) * side)))
