"""What a tracker gets wrong: it is off by millimetres, smoothly over the face and from moment to moment."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

WAVES = 96
WAVELENGTH_M = 0.06
"""Typical length over which the error keeps its direction."""
PERIOD = 12.0
"""The same in timesteps."""


class TrackingNoise:
    """A random smooth field of displacements over the template and time, of mean 0."""

    def __init__(self, rms_m: float, seed: int) -> None:
        """``rms_m`` is the root mean square of the displacement's length, metres."""
        rng = np.random.default_rng([seed, 2])
        self._across = rng.normal(0, 2 * np.pi / WAVELENGTH_M / np.sqrt(3), (3, WAVES))
        self._along = rng.normal(0, 2 * np.pi / PERIOD, WAVES)
        self._phase = rng.uniform(0, 2 * np.pi, WAVES)
        toward = rng.normal(size=(WAVES, 3))
        self._toward = toward * rms_m * np.sqrt(2 / (toward**2).sum())

    def at(self, template: Floats, timestep: int) -> NDArray[np.float32]:
        """Displacements [V, 3] of the vertices [V, 3] at a moment, metres."""
        waves = np.cos(template @ self._across + self._along * timestep + self._phase)
        return (waves @ self._toward).astype(np.float32)
