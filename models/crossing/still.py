"""Jitter: how much an avatar trembles while its driver does nothing at all."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Image
from ..driver.answer import Express
from ..driver.face import FaceTracker
from ..driver.smoothing import OneEuro, Smoothed, step
from ..gem import Gem
from .clip import Clip, UnseenDriver
from .extent import Extent, extent
from .loop import answered
from .reading import Reading, Readings, read, stacked
from .webcam import QUALITY, READ_NOISE, SHOT_NOISE, resensed

FRAMES = 75
SETTLING = 15
"""The first of them, in which tracker and filter find their rest, do not count."""
RATE = 30.0
"""Frames a second."""
CONDITIONS = (FRAMES, READ_NOISE, SHOT_NOISE, QUALITY)
"""What a Still depends on beside its clip."""
_AROUND = 0.6
"""Of a face's longer side, on each side of it: what the tracker looks at."""


@dataclass(frozen=True)
class Still:
    """A driver at his neutral, in front of a webcam."""

    readings: Readings
    """[frames], of one picture under fresh noise."""
    noise: float
    """RMS of what changes from picture to picture in the face, in levels of 255."""


@dataclass(frozen=True)
class Jitter:
    """How far coefficients are from their mean over the frames."""

    raw: Extent
    smoothed: Extent
    """After the filter of the live window."""


def hold_still(clip: Clip, frames: Iterable[tuple[Image, float]]) -> Still:
    """Takes the picture of the clip's neutral again and again with fresh noise, of one seed, and tracks it.

    Args:
        clip: whose neutral.
        frames: the same pictures and times that the clip was tracked from.

    Raises UnseenDriver where the neutral's picture is not among the frames, or shows no face any more.
    """
    tracker = FaceTracker()
    picture = next((picture for picture, now in frames if now >= clip.neutral_time), None)
    face = None if picture is None else tracker.track(picture)
    if picture is None or face is None:
        raise UnseenDriver("the picture of its neutral is gone: the clip changed while it was read")
    left, top, right, bottom = face.box_px
    room = _AROUND * max(right - left, bottom - top)
    height, width = picture.shape[:2]
    box = (
        max(0, int(left - room)),
        max(0, int(top - room)),
        min(width, int(right + room)),
        min(height, int(bottom + room)),
    )
    inside = slice(max(0, int(top)), int(bottom)), slice(max(0, int(left)), int(right))
    rng = np.random.default_rng(0)
    readings: list[Reading] = []
    changes: list[float] = []
    before: NDArray[np.float32] | None = None
    for _ in range(FRAMES):
        noisy = resensed(picture, box, rng)
        shown = noisy[inside].astype(np.float32)
        if before is not None:
            changes.append(float(np.sqrt(((shown - before) ** 2).mean() / 2)))
        before = shown
        face = tracker.track(noisy)
        if face is not None:
            readings.append(read(face))
    if len(readings) <= SETTLING:
        raise UnseenDriver("the tracker loses the face of its neutral under a webcam's noise")
    return Still(stacked(readings), float(np.mean(changes)))


def jitter(still: Still, neutral: Reading, express: Express, gem: Gem, smoothing: OneEuro) -> Jitter:
    """What an avatar makes of it. ``smoothing`` is of coefficients away from rest, in sigma."""
    state: Smoothed | None = None
    raw, smoothed = [], []
    for i in range(len(still.readings)):
        coefficients = answered(express, still.readings[i], neutral).coefficients
        raw.append(coefficients)
        state = step(smoothing, state, (coefficients - gem.rest_coefficients) / gem.sigma, 1 / RATE)
        smoothed.append(state.value * gem.sigma)
    settled = (np.asarray(values[SETTLING:], np.float64) for values in (raw, smoothed))
    return Jitter(*(extent(values - values.mean(0), gem) for values in settled))
