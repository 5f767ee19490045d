"""The closed loop: a clip drives an avatar, and the tracker reads the avatar's own pictures."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..driver.answer import Answer, Express
from ..driver.features import relative_rotation
from .album import Album, bound, packed, small
from .clip import Clip
from .mirror import Mirror
from .reading import Reading, Readings, stacked


@dataclass(frozen=True)
class Echo:
    """What an avatar showed in the F frames of a clip that drove it."""

    readings: Readings
    """Of the pictures in which it was seen, in order."""
    seen: NDArray[np.bool_]
    """[F] whether the tracker saw the avatar."""
    neutral: Reading
    """Of the avatar at rest."""
    coefficients: NDArray[np.float32]
    """[F, n]"""
    pictures: Album
    """[F]"""


def answered(express: Express, reading: Reading, neutral: Reading) -> Answer:
    """What a picture of a driver with this neutral makes an avatar do."""
    return express(reading.features - neutral.features, relative_rotation(reading.rotation, neutral.rotation))


def echo(
    clip: Clip,
    express: Express,
    mirror: Mirror,
    components: int | None = None,
    progress: Callable[[], None] = lambda: None,
) -> Echo:
    """Drives an avatar with all of a clip; ``progress`` is called after each frame.

    Raises UnseenAvatar when the tracker does not see it at rest, or in no frame at all.
    """
    readings: list[Reading] = []
    seen: list[bool] = []
    coefficients: list[NDArray[np.float32]] = []
    pictures: list[NDArray[np.uint8]] = []
    neutral = mirror.neutral(components)
    mirror.restart()
    for i in range(len(clip.readings)):
        answer = answered(express, clip.readings[i], clip.neutral)
        picture = mirror.follow(answer, components)
        reading = mirror.read(picture, clip.looks)
        seen.append(reading is not None)
        if reading is not None:
            readings.append(reading)
        coefficients.append(np.asarray(answer.coefficients, np.float32))
        pictures.append(packed(small(picture)))
        progress()
    return Echo(
        readings=stacked(readings or [neutral]).only(np.arange(len(readings))),
        seen=np.array(seen),
        neutral=neutral,
        coefficients=np.stack(coefficients),
        pictures=bound(pictures),
    )
