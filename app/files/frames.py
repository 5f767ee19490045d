"""One picture of a driver and when it is shown."""

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Frame:
    """A decoded picture, upright, with the timestamp its source gave it."""

    rgb: NDArray[np.uint8]
    """[H, W, 3] sRGB."""
    pts: int
    """Presentation time in units of ``time_base``, exactly as in the source, whose clock begins at 0."""
    time_base: Fraction
    """Seconds per unit of ``pts``."""
    number: int | None = field(default=None, kw_only=True)
    """Position in the source, from 0, where it is known."""

    @property
    def seconds(self) -> float:
        """Presentation time in seconds."""
        return float(self.pts * self.time_base)


def spread(total: int, count: int) -> list[int]:
    """Up to ``count`` of the numbers below ``total``, from 0 on, as evenly as they go."""
    return sorted({place * total // count for place in range(count)}) if total else []


THUMBNAIL_SIDE = 32
LUMA = np.array([0.299, 0.587, 0.114], np.float32) / np.float32(255)
"""Of RGB bytes, in [0, 1]."""
CUT_DIFFERENCE = 0.16
"""Mean absolute change of luma, in [0, 1], between neighbours that no head or camera movement reaches."""


def thumbnail(rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """[32, 32] luma in [0, 1] of single pixels on a grid: enough to see a cut, and nearly free."""
    rows = np.linspace(0, rgb.shape[0] - 1, THUMBNAIL_SIDE).astype(int)
    columns = np.linspace(0, rgb.shape[1] - 1, THUMBNAIL_SIDE).astype(int)
    return np.dot(rgb[np.ix_(rows, columns)].astype(np.float32), LUMA)


def is_cut(before: NDArray[np.float32], after: NDArray[np.float32]) -> bool:
    """Whether two neighbouring thumbnails show different scenes."""
    return bool(np.abs(after - before).mean() > CUT_DIFFERENCE)
