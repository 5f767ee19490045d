"""What the person performs: one sequence to learn from, and one of other expressions to be judged by."""

import numpy as np
from numpy.typing import NDArray

from ..arkit import NAMES
from ..heads.expressions import weights_of
from ..heads.performance import EMOTIONS, VISEMES, gaze, plausible
from .moment import Act

Weights = NDArray[np.float32]

HOLD = 3
"""Timesteps from one face to the next."""
TURN_DEG = (5.0, 9.0, 4.0)
"""How far the head nods, turns and tilts (two standard deviations)."""
SHIFT_M = (0.004, 0.003, 0.004)
BLINK_EVERY = 11
"""Timesteps from one blink to the next."""

EMOTIONS_SHOWN = {
    "train": ("smile", "surprise", "anger", "sad", "laugh", "puff", "calm"),
    "test": ("grin", "disgust", "fear", "doubt", "smirk"),
}
VISEMES_SPOKEN = {
    "train": ("aa", "ou", "E", "PP", "SS", "oh", "RR", "DD"),
    "test": ("FF", "ih", "CH", "TH", "kk", "nn"),
}
"""No expression of one split is shown in the other."""
_SEEDS = {"train": 0, "test": 1}


def perform(split: str, count: int, seed: int) -> list[Act]:
    """``count`` moments of the ``train`` or the ``test`` sequence; that of train begins at rest.

    The same seed gives the same sequence, and a longer one begins as a shorter one does.
    """
    rng = np.random.default_rng([seed, _SEEDS[split]])
    faces = _faces(split, count // HOLD + 2, rng)
    at = np.arange(count) / HOLD
    index = at.astype(int)
    ease = 0.5 - 0.5 * np.cos(np.pi * (at - index))
    weights = faces[index] + ease[:, None].astype(np.float32) * (faces[index + 1] - faces[index])
    blinks = weights_of(eyeBlink=1.0)
    lids = np.zeros(count, np.float32)
    lids[7::BLINK_EVERY] = 1.0
    lids[8::BLINK_EVERY] = 0.55
    weights = np.maximum(weights, lids[:, None] * blinks)
    turns = np.radians(TURN_DEG) / 2 * _wander(count, rng)
    shifts = np.array(SHIFT_M) / 2 * _wander(count, rng)
    if split == "train":
        turns, shifts = turns - turns[0], shifts - shifts[0]
    return [
        Act(w, t.astype(np.float32), s.astype(np.float32))
        for w, t, s in zip(plausible(weights), turns, shifts, strict=True)
    ]


def _faces(split: str, count: int, rng: np.random.Generator) -> Weights:
    """The faces [count, 52] that the sequence goes through: each of the split's own once, then mixtures of them."""
    emotions = [weights_of(**EMOTIONS[name]) for name in EMOTIONS_SHOWN[split]]
    visemes = [weights_of(**VISEMES[name]) for name in VISEMES_SPOKEN[split]]
    looks = [gaze(0.8, 0.1), gaze(-0.8, 0.0), gaze(0.1, 0.8), gaze(0.0, -0.8)]
    own: list[NDArray[np.floating]] = [
        face + (looks[i // 2 % 4] if i % 2 else 0) for i, face in enumerate(emotions + visemes)
    ]
    faces: list[NDArray[np.floating]] = [np.zeros(len(NAMES), np.float32)] if split == "train" else []
    faces += [own[i] for i in rng.permutation(len(own))]
    while len(faces) < count:
        face = rng.uniform(0.3, 1.1) * visemes[rng.integers(len(visemes))]
        face = face + rng.uniform(0.2, 1.0) * emotions[rng.integers(len(emotions))]
        if rng.random() < 0.6:
            face = face + gaze(float(rng.uniform(-0.9, 0.9)), float(rng.uniform(-0.9, 0.9)))
        faces.append(face)
    return np.stack(faces[:count]).astype(np.float32)


def _wander(count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Slow motion [count, 3] of unit spread: a few waves with periods of 9 to 40 timesteps."""
    periods = rng.uniform(9, 40, (6, 3))
    phases = rng.uniform(0, 2 * np.pi, (6, 3))
    time = np.arange(count)[:, None, None]
    return np.sin(2 * np.pi * time / periods + phases).sum(1) / np.sqrt(3)
