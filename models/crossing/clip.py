"""A driver's clip as readings: it streams through the tracker once, and only numbers and small pictures stay."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64, Image
from ..driver.face import LOOKS_APART, FaceObservation, FaceTracker, looked
from ..driver.neutral import NeutralChoice, choose_neutral, other_neutrals
from .album import Album, bound, face_square, packed
from .reading import Reading, Readings, read, stacked

MOST_FRAMES = 3000
"""Of a clip: 40 MB of readings and pictures."""
FEWEST_FRAMES = 8
"""Fewer say nothing about how two things move together."""
OTHERS = 10
"""Neutrals that are tried beside the chosen one."""


class ShortClip(ValueError):
    """Too few frames of a clip were asked for, whatever they show."""


class UnseenDriver(ValueError):
    """Too few frames of a clip show a face."""


@dataclass(frozen=True)
class Clip:
    """One driver; F frames in which a face was seen."""

    readings: Readings
    times: Floats64
    """[F] seconds."""
    neutral: Reading
    neutral_time: float
    """Seconds."""
    reason: str
    """Why this neutral."""
    others: NDArray[np.int64]
    """[at most OTHERS] frames that might have been chosen as well, the best first."""
    pictures: Album
    """[F] faces."""
    lost: int
    """Frames without a face."""
    looks: int
    """At each frame."""

    @property
    def seconds(self) -> float:
        """From the first frame with a face to the last."""
        return float(self.times[-1] - self.times[0])

    @property
    def full(self) -> bool:
        """Whether it has all frames that are kept, whatever the video still shows behind them."""
        return len(self.times) >= MOST_FRAMES


def track_clip(frames: Iterable[tuple[Image, float]], every: int, seconds: float) -> Clip:
    """Tracks each ``every``-th frame of a clip's first ``seconds``, at most MOST_FRAMES.

    Args:
        frames: picture [H, W, 3] and time in seconds, in order.
        every: from 1.
        seconds: since the first frame's time.

    Raises:
        ShortClip: where these are fewer than FEWEST_FRAMES.
        UnseenDriver: where fewer show a face.
    """
    tracker, looks = FaceTracker(), 1 if every == 1 else LOOKS_APART
    faces: list[FaceObservation] = []
    times: list[float] = []
    pictures: list[NDArray[np.uint8]] = []
    lost = 0
    first: float | None = None
    for i, (picture, now) in enumerate(frames):
        if i % every:
            continue
        first = now if first is None else first
        if now - first > seconds or len(faces) == MOST_FRAMES:
            break
        face = looked(tracker, picture, looks)
        if face is None:
            lost += 1
            continue
        faces.append(face)
        times.append(now)
        pictures.append(packed(face_square(picture, face.box_px)))
    if len(faces) + lost < FEWEST_FRAMES:
        raise ShortClip(f"{len(faces) + lost} frames are taken, {FEWEST_FRAMES} are needed")
    if len(faces) < FEWEST_FRAMES:
        raise UnseenDriver(f"a face in {len(faces)} of {len(faces) + lost} frames, {FEWEST_FRAMES} are needed")
    choice = choose_neutral(faces, times)
    readings = stacked([read(face) for face in faces])
    return Clip(
        readings=readings,
        times=np.array(times),
        neutral=_neutral(readings, choice),
        neutral_time=choice.time,
        reason=choice.reason,
        others=np.array([other.index for other in other_neutrals(faces, times, OTHERS)], np.int64),
        pictures=bound(pictures),
        lost=lost,
        looks=looks,
    )


def _neutral(readings: Readings, choice: NeutralChoice) -> Reading:
    """Features and rotation are medians over neighbours, the rest is the chosen frame's."""
    chosen = readings[choice.index]
    return Reading(choice.features, choice.rotation, chosen.landmarks, chosen.embedding)
