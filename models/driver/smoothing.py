"""The One-Euro filter as a value: steady when the face is still, quick when it moves.

Casiez, Roussel, Vogel: "1 EUR filter: a simple speed-based low-pass filter for noisy input in interactive systems",
CHI 2012; the equations are numbered as there.
"""

from dataclasses import dataclass

import numpy as np

from ...render.arrays import Floats


@dataclass(frozen=True)
class OneEuro:
    """The filter's settings; one filter serves any number of values."""

    min_cutoff_hz: float = 1.5
    """Cutoff for a value that stands still, > 0: lower is steadier."""
    beta: float = 0.3
    """Cutoff gained per unit of speed, in Hz / (unit / s), >= 0: higher lags less."""
    derivative_cutoff_hz: float = 1.0
    """Cutoff of the speed itself, > 0."""
    together: bool = False
    """One cutoff for all values, from the fastest of them: what they express together keeps its proportions, where
    values of their own pace would each lag differently."""

    def __post_init__(self) -> None:
        if not (self.min_cutoff_hz > 0 and self.beta >= 0 and self.derivative_cutoff_hz > 0):
            raise ValueError(f"One-Euro needs cutoffs > 0 and beta >= 0, got {self}")


@dataclass(frozen=True)
class Smoothed:
    """What the filter knows after a step."""

    value: Floats
    """[n] the smoothed values."""
    speed: Floats
    """[n] their smoothed speed in units a second."""


def step(settings: OneEuro, state: Smoothed | None, values: Floats, dt: float) -> Smoothed:
    """The next state from values [n] that came ``dt`` seconds after the last.

    Without a state the values are taken as they are; so they are after a ``dt`` <= 0, which a seek in a video gives.
    """
    if state is None or dt <= 0:
        return Smoothed(values, np.zeros_like(values))
    raw_speed = (values - state.value) / dt
    speed = state.speed + _alpha(settings.derivative_cutoff_hz, dt) * (raw_speed - state.speed)
    pace = np.abs(speed).max(initial=0) if settings.together else np.abs(speed)
    cutoff = settings.min_cutoff_hz + settings.beta * pace  # equation 7
    return Smoothed(state.value + _alpha(cutoff, dt) * (values - state.value), speed)  # equation 1


def _alpha(cutoff_hz: Floats | float, dt: float) -> Floats | float:
    """Share of the new value in an exponential filter of this cutoff (equations 2 to 5)."""
    turn = 2 * np.pi * cutoff_hz * dt
    return turn / (turn + 1)
