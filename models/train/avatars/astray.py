"""Whether a training has gone astray: its loss is finite, but far above what it was."""

from collections.abc import Sequence

import numpy as np

LARGER = 2.0
"""What is so many times the least that was reached is no noise."""
LEAST = 8
"""Losses below which a mean says nothing."""


def astray(losses: Sequence[float], every: int) -> bool:
    """Whether training left, since the last checkpoint, what it had learned.

    The last quarters of all stretches of ``every`` losses are compared: by their means, of what is finite. A network
    that Adam has thrown off comes back late or never, and what it forgot is in the checkpoint.
    """
    size = every // 4
    if size < LEAST or len(losses) < 2 * every:
        return False
    ends = [losses[end - size : end] for end in range(len(losses), every - 1, -every)]
    means = [float(np.mean(part, where=np.isfinite(part))) for part in ends if np.isfinite(part).any()]
    return bool(means) and means[0] > LARGER * min(means)
