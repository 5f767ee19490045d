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

    @property
    def luma(self) -> float:
        """Mean luma in [0, 1], of pixels on a grid."""
        return float(thumbnail(self.rgb).mean())


def spread(total: int, count: int) -> list[int]:
    """Up to ``count`` of the numbers below ``total``, from 0 on, as evenly as they go."""
    return sorted({place * total // count for place in range(count)}) if total else []


THUMBNAIL_SIDE = 32
LUMA = np.array([0.299, 0.587, 0.114], np.float32) / np.float32(255)
"""Of RGB bytes, in [0, 1]."""
CUT_DIFFERENCE = 0.16
"""Mean absolute change of luma, in [0, 1], between neighbours that no head or camera movement reaches."""
SAME_SCENE = 0.85
"""Thumbnails that correlate as much show the same scene in another light: those of two clips have -.4 to .3, a lamp
that flickers or goes out leaves .95 or more."""


def thumbnail(rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """[32, 32] luma in [0, 1] of single pixels on a grid: enough to see a cut, and nearly free."""
    rows = np.linspace(0, rgb.shape[0] - 1, THUMBNAIL_SIDE).astype(int)
    columns = np.linspace(0, rgb.shape[1] - 1, THUMBNAIL_SIDE).astype(int)
    return np.dot(rgb[np.ix_(rows, columns)].astype(np.float32), LUMA)


def is_cut(before: NDArray[np.float32], after: NDArray[np.float32]) -> bool:
    """Whether two neighbouring thumbnails show different scenes, and not one in which the light changed."""
    return bool(np.abs(after - before).mean() > CUT_DIFFERENCE and _correlation(before, after) < SAME_SCENE)


def _correlation(before: NDArray[np.float32], after: NDArray[np.float32]) -> float:
    """In [-1, 1]; 0 where one of them is of one colour."""
    before, after = before - before.mean(), after - after.mean()
    return float((before * after).sum() / np.sqrt((before**2).sum() * (after**2).sum() + 1e-12))
