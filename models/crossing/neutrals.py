"""Robustness against the choice of the neutral: the same clip under others that might have been chosen."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64
from ..driver.answer import Express
from ..driver.face import LOOKS_APART
from ..gem import Gem
from .channels import CHANNELS, table
from .clip import Clip
from .compare import FEWEST_SEEN, likeness
from .extent import Extent, extent
from .loop import answered
from .mirror import Mirror
from .reading import Reading, stacked

FRAMES = 24
"""Of a clip, evenly spread, under each neutral."""


@dataclass(frozen=True)
class Swayed:
    """What N neutrals make of one clip, the chosen one first."""

    correlations: Floats64
    """[N, channels] NaN where the driver hardly moves."""
    means: NDArray[np.float32]
    """[N, n] mean coefficients."""


def sway(clip: Clip, express: Express, mirror: Mirror, progress: Callable[[], None] = lambda: None) -> Swayed:
    """Drives the avatar with FRAMES of a clip under each of its neutrals; ``progress`` is called after each of those.

    Raises UnseenAvatar when the tracker does not see it at rest.
    """
    rest = mirror.neutral()
    places = np.unique(np.linspace(0, len(clip.readings) - 1, FRAMES).round().astype(int))
    found, means = [], []
    for neutral in (clip.neutral, *(clip.readings[int(place)] for place in clip.others)):
        mirror.restart()
        answers: list[NDArray[np.floating]] = []
        shown: list[Reading] = []
        seen: list[int] = []
        for place in places:
            answer = answered(express, clip.readings[int(place)], neutral)
            answers.append(answer.coefficients)
            reading = mirror.read(mirror.follow(answer), LOOKS_APART)
            if reading is not None:
                shown.append(reading)
                seen.append(int(place))
        means.append(np.mean(answers, axis=0))
        if len(seen) < FEWEST_SEEN:
            found.append(np.zeros(len(CHANNELS)))
        else:
            driver = table(clip.readings.only(np.array(seen)), neutral)
            found.append(likeness(driver, table(stacked(shown), rest, portrait=True)).correlation)
        progress()
    return Swayed(np.stack(found), np.stack(means))


def spread_of_correlations(swayed: Swayed) -> Floats64:
    """[channels] standard deviation over the neutrals; NaN where the driver hardly moves under the chosen one."""
    return swayed.correlations.std(0)


def spread_of_means(swayed: Swayed, gem: Gem) -> Extent:
    """How far the mean coefficients are from their average over the neutrals."""
    return extent(swayed.means - swayed.means.mean(0), gem)
