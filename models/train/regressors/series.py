"""Pictures of an avatar in series, each with random numbers of its own, so that several processes can draw them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...gem import Gem
from ..workers import ALONE, Advance, Workers
from .controls import Controls
from .response import ITSELF, Responses, Sitting, joined, measure_responses

LENGTH = 500
"""Pictures of a series."""


@dataclass(frozen=True)
class Series:
    """What is drawn one after the other."""

    weights: NDArray[np.float32]
    """[S, E] control weights."""
    rng: np.random.Generator
    """Framing, light, and rotations where none are given."""
    rotations: NDArray[np.float32] | None = None
    """[S, 3] of the head, radians."""
    sitting: Sitting = ITSELF


def in_series(
    weights: NDArray[np.float32],
    rng: np.random.Generator,
    rotations: NDArray[np.float32] | None = None,
    sitting: Sitting = ITSELF,
) -> list[Series]:
    """Control weights [S, E], and rotations [S, 3] where they are given, in series of LENGTH."""
    firsts = range(0, len(weights), LENGTH)
    return [
        Series(
            weights[first : first + LENGTH],
            own,
            None if rotations is None else rotations[first : first + LENGTH],
            sitting,
        )
        for first, own in zip(firsts, rng.spawn(len(firsts)), strict=True)
    ]


def draw_series(
    gem: Gem,
    controls: Controls,
    series: Sequence[Series],
    progress: Callable[[int, int], None] = lambda done, total: None,
    workers: Workers = ALONE,
) -> Responses:
    """Draws and reads an avatar; see ``measure_responses``. The pictures are the same however many draw them.

    Raises AvatarNotSeen where its neutral shows no face, WorkerLost.
    """
    total = sum(len(one.weights) for one in series)
    parts = workers.each(_drawn, [(gem, controls, one) for one in series], lambda done: progress(done, total))
    return joined(parts)


def _drawn(advance: Advance, gem: Gem, controls: Controls, series: Series) -> Responses:
    return measure_responses(
        gem, controls, series.weights, series.rng, lambda done, total: advance(), series.rotations, series.sitting
    )
