"""Pose leak: what an avatar's expression does while nothing but the driver's head turns."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64
from ..driver.answer import Express
from ..driver.face import LOOKS_APART
from ..gem import Gem
from .extent import Extent, extent
from .loop import answered
from .mirror import LOOKS, Mirror, UnseenAvatar
from .reading import Reading, Readings, stacked

YAW_DEG, PITCH_DEG = 20.0, 15.0
"""How far to either side, and up and down."""
GOAL = 0.25
"""Of the RMS of expression, at most, at YAW_DEG."""
SIDE_STEPS, ROUND_STEPS = 8, 16
"""From the front to one end; around an ellipse through all four ends."""


@dataclass(frozen=True)
class Turned:
    """An avatar that keeps its expression, seen by the tracker while its head turns."""

    readings: Readings
    """[T] where the tracker saw it."""
    angles: Floats64
    """[T, 2] yaw and pitch, degrees."""
    neutral: Reading
    """Straight ahead."""


@dataclass(frozen=True)
class Leak:
    """How far coefficients go from what the neutral gives."""

    at_yaw: Extent
    """At YAW_DEG to either side."""
    all: Extent
    """Over the whole path."""


def path() -> Floats64:
    """[T, 2] yaw and pitch in degrees: to each side, up and down, and around."""
    out = np.linspace(0, 1, SIDE_STEPS + 1)[1:]
    back = out[::-1]
    sweep = np.concatenate([out, back, -out, -back])
    around = np.linspace(0, 2 * np.pi, ROUND_STEPS, endpoint=False)
    return np.concatenate(
        [
            np.stack([YAW_DEG * sweep, 0 * sweep], 1),
            np.stack([0 * sweep, PITCH_DEG * sweep], 1),
            np.stack([YAW_DEG * np.sin(around), PITCH_DEG * np.cos(around)], 1),
        ]
    )


def turn(mirror: Mirror) -> Turned:
    """Draws the avatar at rest along ``path`` and reads it. Raises UnseenAvatar where it is not seen to both sides."""
    neutral = mirror.neutral()
    readings: list[Reading] = []
    angles: list[NDArray[np.float64]] = []
    for yaw, pitch in path():
        picture = mirror.draw(mirror.gem.rest_coefficients, np.radians([pitch, yaw, 0.0]))
        reading = mirror.read(picture, LOOKS_APART if readings else LOOKS)
        if reading is not None:
            readings.append(reading)
            angles.append(np.array([yaw, pitch]))
    sides = {np.sign(yaw) for yaw, pitch in angles if abs(yaw) == YAW_DEG and pitch == 0}
    if sides != {-1.0, 1.0}:
        raise UnseenAvatar(f"the tracker does not see avatar {mirror.gem.name!r} turned {YAW_DEG:g} degrees to a side")
    return Turned(stacked(readings), np.array(angles), neutral)


def leak(turned: Turned, express: Express, gem: Gem) -> Leak:
    """What a driver that only turns his head makes an avatar's expression do."""
    still = answered(express, turned.neutral, turned.neutral).coefficients
    readings = (turned.readings[i] for i in range(len(turned.readings)))
    answers = np.stack([answered(express, reading, turned.neutral).coefficients for reading in readings])
    sideways = (np.abs(turned.angles[:, 0]) == YAW_DEG) & (turned.angles[:, 1] == 0)
    return Leak(extent((answers - still)[sideways], gem), extent(answers - still, gem))
