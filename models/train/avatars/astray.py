"""Whether a training has gone astray: its loss is finite, but far above what it was."""

from collections.abc import Sequence

import numpy as np

LARGER = 2.0
"""What is so many times the least that was reached is no noise."""
LEAST = 8
"""Losses below which a mean says nothing."""


def astray(losses: Sequence[float], every: int) -> bool:
    """Whether training left, since the last checkpoint, what it had learned; asked after each ``every`` losses.

    The mean of the last quarter of them is compared with those of all stretches of that length before it, of what is
    finite: those before the first checkpoint, too, where the surface is still bare. A network that Adam has thrown off
    comes back late or never, and what it forgot is in the checkpoint.
    """
    size = every // 4
    if size < LEAST or len(losses) < every:
        return False
    ends = [losses[end - size : end] for end in range(len(losses), size - 1, -size)]
    means = [float(np.mean(part, where=np.isfinite(part))) for part in ends if np.isfinite(part).any()]
    return bool(np.isfinite(losses[-size:]).any()) and means[0] > LARGER * min(means)
