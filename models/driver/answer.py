"""What a face makes an avatar do, and the way of telling that learned nothing."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ...render.arrays import Floats
from ..gem import Gem
from .axes import drawn_turn
from .baseline import baseline_weights
from .nodding import nodding_of


@dataclass(frozen=True)
class Answer:
    """To one picture of a driver."""

    coefficients: Floats
    """[coefficients] the expression."""
    turn: Floats
    """[3] how the head turns from its rest, a rotation vector in radians: so that the driver's rotation is read on it,
    less what an expression only seems to turn."""
    misread: Floats = field(default_factory=lambda: np.zeros(3))
    """[3] radians by which it would turn further without what was taken off."""

    @classmethod
    def seen_as(cls, coefficients: Floats, rotation: Floats, turn: Floats) -> "Answer":
        """Of a driver on whom ``rotation`` [3] is read, ``turn`` [3] when what only seems to turn is taken off."""
        drawn = drawn_turn(turn)
        return cls(coefficients, drawn, drawn_turn(rotation) - drawn)


Express = Callable[[Floats, Floats], Answer]
"""Relative features [D] and the head's rotation from its neutral [3] to what an avatar does. A ``Regressor`` is one."""


def by_scores(gem: Gem) -> Express:
    """The baseline's: relative scores as ARKit weights. Raises ValueError for an avatar that knows no ARKit shapes."""
    if gem.arkit_weights is None:
        raise ValueError(f"avatar '{gem.name}' knows no ARKit shapes")
    nodding = nodding_of(gem)

    def answer(features: Floats, rotation: Floats) -> Answer:
        coefficients = gem.clamped(gem.arkit_coefficients(baseline_weights(features)))
        return Answer.seen_as(coefficients, rotation, nodding.taken_off(rotation, coefficients))

    return answer
