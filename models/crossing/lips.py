"""Whether lips part when the driver's do, and how far: no correlation shows a mouth that stays shut till it is wide."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..driver.features import BLOCKS
from ..driver.measures import MEASURES
from .reading import Reading, Readings

PARTED_MM, SHUT_MM = 3.0, 1.2
"""Lips that stand apart by so much more than at rest are parted, by so much less than that shut; between, who knows."""
_GAP = BLOCKS["measures"].start + MEASURES.index("lip_gap")
_MM_A_CM = np.float32(10)


@dataclass(frozen=True)
class Lips:
    """A driver's lips beside his avatar's, over the frames in which both were seen."""

    off_mm: float
    """By how much more or less than the driver's the avatar's lips part (RMS); NaN over no frames."""
    shut: float
    """Share of the frames with the driver's lips parted in which the avatar's are shut; NaN where his never part."""


def lips(driver: Readings, neutral: Reading, avatar: Readings, rest: Reading) -> Lips:
    """Of the same frames, each against its own neutral."""
    led, shown = _parting(driver, neutral), _parting(avatar, rest)
    return Lips(_mean((led - shown) ** 2) ** 0.5, _mean(shown[led > PARTED_MM] < SHUT_MM))


def _parting(readings: Readings, rest: Reading) -> NDArray[np.float32]:
    return (readings.features[:, _GAP] - rest.features[_GAP]) * _MM_A_CM


def _mean(values: NDArray[np.floating] | NDArray[np.bool_]) -> float:
    return float(values.mean()) if len(values) else float("nan")
