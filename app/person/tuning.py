"""How the driver's face becomes the avatar's: smoothing, gain by group, head, neutral; what the sliders set."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

import numpy as np

from ...models.arkit import NAMES
from ...models.driver.answer import Express
from ...models.driver.neutral import NeutralChoice
from ...models.driver.smoothing import OneEuro
from ...models.gem import Gem
from ...render.arrays import Floats
from ..performing.casting import Avatar
from .following import EXPRESSION_FILTER, MISREAD_FILTER, TURN_FILTER, Actor, Tracker

Group = Literal["mouth", "eyes", "brows", "head"]
GROUPS: tuple[Group, ...] = get_args(Group)
MOST_GAIN = 2.0
NOTCH = 0.15
"""How much a picture that is hard to read adds to the smoothing."""
_SMOOTHEST = 8.0
"""At full smoothing the filters' cutoffs are divided by this, at none multiplied."""
_RIDGE = 1e-3
"""Of the mean square of a shape: keeps shapes that look alike from being told apart by noise."""

_NOBODY = NeutralChoice(0, 0.0, np.zeros(0, np.float32), np.zeros(3), "", ())


@dataclass(frozen=True)
class Tuning:
    """One position of all sliders. Raises ValueError for one that no slider has."""

    smoothing: float = 0.5
    """0 follows every tremble, 1 floats; 0.5 is what offline reenactment does."""
    gains: Mapping[str, float] = field(default_factory=dict)
    """Group -> 0 (still) to 2 (twice); groups that are not named have 1."""
    head_pose: bool = True
    """Whether the head turns with the driver's."""
    neutral_strength: float = 1.0
    """0 the neutral found automatically, 1 the one that was taken; between them in between."""
    detector_every: int = 1
    """Only every so manieth frame is looked at: 2 halves the work on a slow machine."""

    def __post_init__(self) -> None:
        unknown = set(self.gains) - set(GROUPS)
        within = 0 <= self.smoothing <= 1 and 0 <= self.neutral_strength <= 1 and self.detector_every >= 1
        if unknown or not within or not all(0 <= gain <= MOST_GAIN for gain in self.gains.values()):
            raise ValueError(f"no such tuning: {self}; gains are 0..{MOST_GAIN:g} of {', '.join(GROUPS)}, others 0..1")

    def gain(self, group: Group) -> float:
        """The gain of a group."""
        return self.gains.get(group, 1.0)


def group_of(shape: str) -> Group:
    """The group of an ARKit shape."""
    if shape.startswith("brow"):
        return "brows"
    return "eyes" if shape.startswith(("eye", "cheekSquint")) else "mouth"


def smoother(filter_settings: OneEuro, smoothing: float) -> OneEuro:
    """The filter with its cutoffs moved: unchanged at 0.5."""
    factor = _SMOOTHEST ** (1 - 2 * smoothing)
    return replace(
        filter_settings, min_cutoff_hz=filter_settings.min_cutoff_hz * factor, beta=filter_settings.beta * factor
    )


def actor_for(avatar: Avatar, tracker: Tracker, express: Express, tuning: Tuning, hard_to_read: bool) -> Actor:
    """Who plays under a tuning, still without a neutral; one notch smoother where the face is hard to read."""
    smoothing = min(1.0, tuning.smoothing + NOTCH * hard_to_read)
    return Actor(
        tracker,
        _NOBODY,
        express,
        avatar.gem,
        avatar.lids,
        tuning.head_pose,
        smoother(EXPRESSION_FILTER, smoothing),
        smoother(TURN_FILTER, smoothing),
        gain_matrix(avatar.gem, tuning),
        tuning.gain("head"),
        smoother(MISREAD_FILTER, smoothing),
    )


def gain_matrix(gem: Gem, tuning: Tuning) -> Floats | None:
    """[coefficients, coefficients] that multiplies, from the right, coefficients away from rest; None for no change.

    The part of an expression that ARKit shapes explain (ridge regression in units of sigma) is scaled shape by shape;
    the rest stays. None also for an avatar without coefficients, and for one without an ARKit map, of which nobody
    knows what moves its mouth.
    """
    extra = np.array([tuning.gain(group_of(shape)) - 1 for shape in NAMES])
    if gem.arkit_weights is None or not gem.coefficient_count or not extra.any():
        return None
    sigma = gem.sigma.astype(float)  # a file may say 1e-30, whose squares are too much for 32 bits
    shapes = gem.arkit_weights / sigma  # [52, coefficients]
    gram = shapes @ shapes.T
    ridge = _RIDGE * float(np.trace(gram)) / len(gram) * np.eye(len(gram))
    explained = np.linalg.solve(gram + ridge, shapes).T  # [coefficients, 52]: sigmas to weights
    return np.eye(len(sigma)) + (explained / sigma[:, None] * extra) @ (shapes * sigma)
