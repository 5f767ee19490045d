"""What an avatar does while nobody drives it: it breathes, and blinks now and then."""

import numpy as np
from numpy.typing import NDArray

BREATH_SECS = 4.2
BREATH_RADIANS = 0.006
BLINK_EVERY_SECS = 3.7
BLINK_SECS = 0.22


def breath(seconds: float) -> NDArray[np.float64]:
    """[3] rotation of the head, radians: a slow nod."""
    return np.array([BREATH_RADIANS * np.sin(2 * np.pi * seconds / BREATH_SECS), 0.0, 0.0])


def lids_closed(seconds: float) -> float:
    """How far the lids are down, in [0, 1]; 0 most of the time and at 0 s.

    Every blink comes at another point of its interval (the golden ratio spreads them): it never ticks like a clock.
    """
    interval, within = divmod(seconds, BLINK_EVERY_SECS)
    start = 0.3 + (BLINK_EVERY_SECS - BLINK_SECS - 0.3) * ((interval * 0.618034 + 0.4) % 1)
    phase = (within - start) / BLINK_SECS
    return float(np.sin(np.pi * phase)) if 0 < phase < 1 else 0.0
