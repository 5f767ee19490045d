"""How long one step of reenactment takes: all ways of driving by turns, so that a busy machine is equally unfair."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..driver.answer import Express
from .clip import Clip
from .loop import answered
from .mirror import Mirror

STEPS, WARMING = 30, 3
"""Frames that count, and before them some that do not."""


@dataclass(frozen=True)
class Pace:
    """Medians over STEPS frames, seconds."""

    step: float
    """From features to a picture: express, compose, pose, draw."""
    tracking: float
    """Tracking a face in a picture of that size."""


def paces(clip: Clip, ways: Sequence[Express], mirror: Mirror) -> list[Pace]:
    """One for each way of driving the avatar of ``mirror``, by frames spread over a clip."""
    places = np.linspace(0, len(clip.readings) - 1, WARMING + STEPS).round().astype(int)
    spent = np.empty((len(places), len(ways), 2))
    mirror.restart()
    for turn, place in enumerate(places):
        reading = clip.readings[int(place)]
        for way, express in enumerate(ways):
            began = time.perf_counter()
            picture = mirror.follow(answered(express, reading, clip.neutral))
            drawn = time.perf_counter()
            mirror.read(picture)
            spent[turn, way] = drawn - began, time.perf_counter() - drawn
    return [Pace(float(step), float(tracking)) for step, tracking in np.median(spent[WARMING:], axis=0)]
