"""The studio's light: a few large soft lamps and an even room, as directions to sample and as lobes to mirror."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

LAMPS = (
    # direction to the lamp, radiance, concentration (von Mises-Fisher), samples: key, fill, sky, two rims, floor
    ((-0.55, 0.60, 0.75), (3.55, 3.36, 3.10), 14.0, 20),
    ((0.80, 0.10, 0.70), (0.34, 0.37, 0.42), 4.0, 10),
    ((0.00, 1.00, 0.25), (0.55, 0.57, 0.62), 2.0, 12),
    ((0.85, 0.45, -0.55), (1.35, 1.38, 1.45), 9.0, 10),
    ((-0.85, 0.35, -0.65), (0.60, 0.63, 0.70), 8.0, 8),
    ((0.00, -1.00, 0.50), (0.20, 0.17, 0.15), 2.0, 8),
)
ROOM = (0.29, 0.30, 0.32)
"""Radiance of everything else."""
ROOM_SAMPLES = 28
SEED = 3
"""Of the turn in which a lamp's samples are laid out."""
BOUNCE = (0.24, 0.15, 0.12)
"""What a blocked direction still sends: light from other skin."""
BULBS = (((-0.40, 0.34, 0.85), 1.0), ((0.45, -0.06, 0.89), 0.4))
"""The bright middles of key and fill, which a wet eye mirrors: directions and strengths."""


@dataclass(frozen=True)
class Lighting:
    """The lamps, ready for sampling. One direction of light for each sample."""

    toward: NDArray[np.float32]
    """[D, 3] unit directions to the light."""
    radiance: NDArray[np.float32]
    """[D, 3] irradiance / pi that each brings to a surface that faces it."""
    bounced: NDArray[np.float32]
    """[D, 3] what it brings where something is in the way."""
    lamp: NDArray[np.int32]
    """[D] which lamp a sample is of; the number of lamps for the room."""
    lobes: NDArray[np.float32]
    """[lamps, 7] unit direction, radiance, concentration: what shiny surfaces mirror."""
    bulbs: NDArray[np.float32]
    """[2, 4] unit direction, strength: what eyes mirror sharply."""


def studio_light() -> Lighting:
    """The light of the studio, the same samples each time."""
    rng = np.random.default_rng(SEED)
    toward, radiance, bounced, lamp, lobes = [], [], [], [], []
    for index, (direction, color, width, count) in enumerate(LAMPS):
        axis = np.array(direction) / np.linalg.norm(direction)
        toward.append(_around(axis, width, count, float(rng.uniform(0, 2 * np.pi))))
        # the lobe's integral over the sphere, shared among the samples
        share = 2 * np.pi * (1 - np.exp(-2 * width)) / width / count / np.pi
        radiance.append(np.tile(np.array(color) * share, (count, 1)))
        bounced.append(np.zeros((count, 3)))
        lamp.append(np.full(count, index))
        lobes.append([*axis, *color, width])
    even = _around(np.array([0.0, 1.0, 0.0]), 1e-4, ROOM_SAMPLES, float(rng.uniform(0, 2 * np.pi)))
    toward.append(even)
    radiance.append(np.tile(np.array(ROOM) * 4 / ROOM_SAMPLES, (ROOM_SAMPLES, 1)))
    bounced.append(np.tile(np.array(BOUNCE) * 4 / ROOM_SAMPLES, (ROOM_SAMPLES, 1)))
    lamp.append(np.full(ROOM_SAMPLES, len(LAMPS)))
    return Lighting(
        np.concatenate(toward).astype(np.float32),
        np.concatenate(radiance).astype(np.float32),
        np.concatenate(bounced).astype(np.float32),
        np.concatenate(lamp).astype(np.int32),
        np.array(lobes, np.float32),
        np.array([[*(np.array(d) / np.linalg.norm(d)), strength] for d, strength in BULBS], np.float32),
    )


def _around(axis: Floats, width: float, count: int, turn: float) -> Floats:
    """Directions [count, 3] of a von Mises-Fisher lobe, spread evenly in a sunflower's spiral."""
    share = (np.arange(count) + 0.5) / count
    up = 1 + np.log(share + (1 - share) * np.exp(-2 * width)) / width
    across = np.sqrt(np.clip(1 - up * up, 0, 1))
    angle = turn + np.pi * (3 - np.sqrt(5)) * np.arange(count)
    helper = np.array([1.0, 0, 0]) if abs(axis[0]) < 0.7 else np.array([0, 1.0, 0])
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    y = np.cross(axis, x)
    return up[:, None] * axis + across[:, None] * (np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y)
