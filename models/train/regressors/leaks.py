"""Pose leak: what the turn of a head adds to features, as a quadratic function of its rotation.

Half of what a turn adds is the same to either side: a mouth that looks pursed from the left looks so from the
right.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....render.arrays import Floats32
from .response import TYPICAL, Responses

_FIRST, _SECOND = np.triu_indices(3)
FACTORS = np.eye(3, dtype=np.float32)[:, _FIRST], np.eye(3, dtype=np.float32)[:, _SECOND]
"""Both [3, 6]: rotations times the one, times rotations times the other, are their squares and products."""
TERMS = 3 + len(_FIRST)
_PENALTY = 1e-4
"""Of a term, in squared radians."""


def turned(rotations: Floats32) -> Floats32:
    """[S, TERMS] pitch, yaw and roll [S, 3], radians, their squares and products."""
    products = (rotations @ FACTORS[0]) * (rotations @ FACTORS[1]) / TYPICAL
    return np.concatenate([rotations, products], 1).astype(np.float32)


def pose_leak(responses: Responses) -> Floats32:
    """[TERMS, D] what head rotation alone adds to a head's features (least squares beside the weights)."""
    weights = responses.weights[:, (responses.weights != 0).any(0)]
    inputs = np.concatenate([turned(responses.rotations), weights, np.ones((len(responses), 1), np.float32)], 1)
    penalty = _PENALTY * len(responses) * np.eye(inputs.shape[1], dtype=np.float32)
    return np.linalg.solve(inputs.T @ inputs + penalty, inputs.T @ responses.features)[:TERMS].astype(np.float32)


@dataclass(frozen=True)
class Leaks:
    """Of H heads."""

    known: Floats32
    """[H, TERMS, D]"""

    @property
    def mean(self) -> NDArray[np.float32]:
        """[TERMS, D]"""
        return self.known.mean(0).astype(np.float32)

    def of_others(self, rotations: Floats32, spread: Floats32, rng: np.random.Generator) -> Floats32:
        """[S, D] what rotations [S, 3] add to features, each of a head of its own, which lies between two of those
        known and beyond. ``spread`` [S]: how far such heads differ from the mean, against those known."""
        count, heads = len(rotations), len(self.known)
        angle = rng.uniform(0, 2 * np.pi, count)
        shares = np.zeros((count, heads), np.float32)
        for share in (np.cos(angle), np.sin(angle)):
            shares[np.arange(count), rng.integers(heads, size=count)] += spread * share
        shares += (1 - shares.sum(1, keepdims=True)) / heads
        terms = (shares[:, :, None] * turned(rotations)[:, None, :]).reshape(count, -1)
        return terms @ self.known.reshape(-1, self.known.shape[2])
