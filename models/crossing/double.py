"""A double who does exactly what the driver does: the driver's own mirror image, in the avatar's place.

The tracker reads the two sides of a face by the same network and yet not alike. No avatar can be asked to follow better
than the driver's own face does, seen in a mirror.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64, Image
from ..driver.face import FaceTracker, looked
from .channels import CHANNELS, correlations, table
from .clip import Clip
from .compare import FEWEST_SEEN
from .reading import Reading, Readings, read, stacked

SWAPPED = ("gaze horizontal", "yaw", "roll", "iris horizontal")
"""Channels that change their sign in a mirror."""
_SIGNS = np.array([-1.0 if channel.name in SWAPPED else 1.0 for channel in CHANNELS])


@dataclass(frozen=True)
class Double:
    """What the tracker reads in a mirror of the F frames of a clip."""

    readings: Readings
    """Of the mirror images in which a face was seen, in order."""
    seen: NDArray[np.bool_]
    """[F]"""


def mirrored(clip: Clip, frames: Iterable[tuple[Image, float]]) -> Double:
    """Tracks the mirror images of a clip's frames; ``frames`` are those that it was tracked from."""
    tracker = FaceTracker()
    readings: list[Reading] = []
    seen = np.zeros(len(clip.times), bool)
    place = 0
    for picture, now in frames:
        if place == len(seen):
            break
        if now < clip.times[place]:
            continue
        face = looked(tracker, np.ascontiguousarray(picture[:, ::-1]), clip.looks)
        if face is not None:
            seen[place] = True
            readings.append(read(face))
        place += 1
    return Double(stacked(readings or [clip.neutral]).only(np.arange(len(readings))), seen)


def double_correlations(clip: Clip, double: Double) -> Floats64:
    """[channels] correlation over frames of driver and double; NaN where the driver hardly moves, or the double was
    hardly seen."""
    if double.seen.sum() < FEWEST_SEEN:
        return np.full(len(CHANNELS), np.nan)
    rest = int(np.abs(clip.times[double.seen] - clip.neutral_time).argmin())
    shown = table(double.readings, double.readings[rest])
    return correlations(table(clip.readings.only(double.seen), clip.neutral), _SIGNS * shown)
