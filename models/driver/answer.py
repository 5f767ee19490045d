"""What a face makes an avatar do, and the way of telling that learned nothing."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..gem import Gem
from .baseline import baseline_weights
from .nodding import nodding_of

Floats = NDArray[np.floating]


@dataclass(frozen=True)
class Answer:
    """To one picture of a driver."""

    coefficients: Floats
    """[coefficients] the expression."""
    turn: Floats
    """[3] how the head turns from its rest, a rotation vector in radians: the driver's rotation, less what an
    expression only seems to turn."""
    misread: Floats = field(default_factory=lambda: np.zeros(3))
    """[3] radians that were taken off what was read on the driver."""


Express = Callable[[Floats, Floats], Answer]
"""Relative features [D] and the head's rotation from its neutral [3] to what an avatar does. A ``Regressor`` is one."""


def by_scores(gem: Gem) -> Express:
    """The baseline's: relative scores as ARKit weights. Raises ValueError for an avatar that knows no ARKit shapes."""
    if gem.arkit_weights is None:
        raise ValueError(f"avatar '{gem.name}' knows no ARKit shapes")
    nodding = nodding_of(gem)

    def answer(features: Floats, rotation: Floats) -> Answer:
        coefficients = gem.clamped(gem.arkit_coefficients(baseline_weights(features)))
        turn = nodding.taken_off(rotation, coefficients)
        return Answer(coefficients, turn, rotation - turn)

    return answer
