"""Relative features as other people would give them: other avatars, other gains, other leaks of head pose, noise."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..driver.features import BLOCKS, DIMENSION
from .response import Responses

GAIN_SPREAD = 0.35
"""Standard deviation of the logarithm of how strongly a person moves a channel, against the avatars."""
NOISE = {"mesh": 0.02, "gaze": 0.02, "measures": 0.03, "scores": 0.01, "mixer": 0.02}
"""Standard deviation of the tracker's noise per block, in the block's unit."""


@dataclass(frozen=True)
class Crowd:
    """S moments of people who are not the avatar."""

    features: NDArray[np.float32]
    """[S, D] relative features."""
    rotations: NDArray[np.float32]
    """[S, 3] relative head rotation, radians."""


def pose_leak(responses: Responses) -> NDArray[np.float32]:
    """[3, D] what head rotation alone adds to an avatar's features, per radian (least squares beside the weights)."""
    inputs = np.concatenate([responses.rotations, responses.weights, np.ones((len(responses), 1), np.float32)], 1)
    penalty = 1e-2 * len(responses) / 100 * np.eye(inputs.shape[1], dtype=np.float32)
    return np.linalg.solve(inputs.T @ inputs + penalty, inputs.T @ responses.features)[:3].astype(np.float32)


def crowd(sources: list[Responses], footage: NDArray[np.float32], count: int, rng: np.random.Generator) -> Crowd:
    """``count`` moments of invented people.

    Each is a picture of one of ``sources``, its channels multiplied by gains of their own, its pose leak exchanged for
    a mixture of all leaks, with noise; a third of them are taken from ``footage`` [S, D + 3] (features and rotations
    of unlabelled real faces) where there is any.
    """
    leaks = np.stack([pose_leak(source) for source in sources])
    which = rng.integers(len(sources), size=count)
    features = np.empty((count, DIMENSION), np.float32)
    rotations = np.empty((count, 3), np.float32)
    for index, source in enumerate(sources):
        rows = np.flatnonzero(which == index)
        picked = rng.integers(len(source), size=len(rows))
        features[rows], rotations[rows] = source.features[picked], source.rotations[picked]
    mixture = rng.dirichlet(np.ones(len(sources)), count) * rng.normal(1, 0.4, (count, 1))
    mixture[np.arange(count), which] -= 1
    features += np.einsum("sa,aid,si->sd", mixture, leaks, rotations, optimize=True)
    if len(footage):
        rows = rng.random(count) < 1 / 3
        picked = rng.integers(len(footage), size=int(rows.sum()))
        features[rows], rotations[rows] = footage[picked, :DIMENSION], footage[picked, DIMENSION:]
    features *= np.exp(rng.normal(0, GAIN_SPREAD / 2, (count, 1)) + rng.normal(0, GAIN_SPREAD, (count, DIMENSION)))
    for name, spread in NOISE.items():
        features[:, BLOCKS[name]] += rng.normal(0, spread, features[:, BLOCKS[name]].shape)
    return Crowd(features.astype(np.float32), rotations)
