"""Relative features as other people would give them: other avatars, other gains, other leaks of head pose, noise.

With each goes what the same expression adds to a face that is turned alike: an avatar that repeats *that* does not pull
a face where the driver only turns his head, and is read as he is, turned as he is.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ....render.arrays import Floats32
from ...driver.features import BLOCKS, DIMENSION
from .channels import channel_indices, channel_tolerances, mouth_channels
from .leaks import Leaks, pose_leak, turned
from .response import ResponseModel, Responses, at_rest

GAIN_SPREAD = 0.35
"""Standard deviation of the logarithm of how strongly a person moves a channel, against the avatars."""
MOUTH_SPREAD = 0.5
"""Standard deviation of what is added to each channel of an invented person's mouth, in that channel's own spread, for
a mouth that moves as much as most do; for others in proportion. Channels go together otherwise on people's mouths than
on avatars'; a regressor that knows the latter alone takes strangers' mouths for those of an avatar."""
RESTING_LEAK_SPREAD = 1.6
"""How far the pose leak of other people differs from the mean, against that of the heads that are known, where their
face does nothing else: farther, for these are few, and all shaped like avatars ..."""
LEAK_SPREAD = 0.4
"""... and where it does: whoever doubts all that a turned head shows does not follow it, puckers and brows first."""
AT_ONCE = 20_000
"""Moments are invented in parts of so many: all of them together would take twice the memory."""
NOISE = {"mesh": 0.01, "gaze": 0.01, "measures": 0.015, "scores": 0.005, "mixer": 0.02}
"""Standard deviation of the tracker's noise per block, in the block's unit. Twice as much would be a fifth of a
small jaw."""


@dataclass(frozen=True)
class Person:
    """Somebody whose pictures are known."""

    seen: Responses
    response: ResponseModel
    """Learned from them."""
    doubters: tuple[ResponseModel, ...] = ()
    """The same learned with other random numbers: where they disagree, it is not known how the person answers."""
    arkit: bool = False
    """Whether the control weights are those of ARKit's shapes, which stand for the same on everybody."""


@dataclass(frozen=True)
class Crowd:
    """S moments of people who are not the avatar."""

    features: Floats32
    """[S, D] relative features."""
    rotations: Floats32
    """[S, 3] relative head rotation as the tracker reads it, radians."""
    wanted: Floats32
    """[S, T] the compared channels, in tolerances, by which an avatar that does the same, and turns alike, shall differ
    from itself at rest."""
    resting: NDArray[np.bool_]
    """[S] moments in which nothing but the head moves."""
    turns: Floats32
    """[S, 3] the rotation that was drawn, radians; of footage, the one that is read."""
    acted: Floats32
    """[S, E] the control weights that these people act; NaN where nobody knows, or they stand for something else."""

    def __len__(self) -> int:
        return len(self.features)


def expressed(person: Person) -> Floats32:
    """[S, T] what the expressions of a person's pictures add to a face that is turned alike, in tolerances.

    What the response says that the turn adds to a face at rest is taken off; what else is read, noise and all that the
    response does not know, stays: on people, too, it is what is read that shall be followed. Of a face at rest nothing
    stays.
    """
    weights, rotations = torch.from_numpy(person.seen.weights), torch.from_numpy(person.seen.rotations)
    rest = torch.zeros(1, weights.shape[1])
    with torch.no_grad():
        turned = person.response(rest.expand(len(weights), -1), rotations) - person.response(rest, torch.zeros(1, 3))
    channels = in_tolerances(person.seen.features) - turned.numpy()
    return np.where(at_rest(person.seen.weights)[:, None], 0, channels).astype(np.float32)


def in_tolerances(features: Floats32) -> Floats32:
    """[S, T] the compared channels of relative features [S, D]."""
    return (features[:, channel_indices()] / channel_tolerances()).astype(np.float32)


def crowd(
    people: Sequence[Person],
    others: Leaks,
    footage: Floats32,
    count: int,
    rng: np.random.Generator,
    by_pictures: bool = False,
) -> Crowd:
    """``count`` moments of invented people.

    Each is a picture of one of ``people`` (all alike, or ``by_pictures`` in proportion to how many there are of each,
    so that every picture is used as often), its mouth another's, its channels multiplied by gains of their own, its
    pose leak exchanged for that of one more head like the ``others``, with noise; a third of them are taken from
    ``footage`` [S, D + 3] (features and rotations of unlabelled real faces) where there is any, whose leak is taken to
    be the mean of the others'.
    """
    leaks = [pose_leak(person.seen) for person in people]
    expressions = [expressed(person) for person in people]
    sizes = [min(AT_ONCE, count - first) for first in range(0, count, AT_ONCE)]
    whose = np.repeat(np.arange(len(people)), [len(person.seen) if by_pictures else 1 for person in people])
    parts = [_invented(people, whose, leaks, expressions, others, footage, size, rng) for size in sizes]
    return Crowd(
        np.concatenate([part.features for part in parts]),
        np.concatenate([part.rotations for part in parts]),
        np.concatenate([part.wanted for part in parts]),
        np.concatenate([part.resting for part in parts]),
        np.concatenate([part.turns for part in parts]),
        np.concatenate([part.acted for part in parts]),
    )


def _invented(
    people: Sequence[Person],
    whose: NDArray[np.int64],
    leaks: Sequence[Floats32],
    expressions: Sequence[Floats32],
    others: Leaks,
    footage: Floats32,
    count: int,
    rng: np.random.Generator,
) -> Crowd:
    """``leaks`` and ``expressions`` are the people's, by ``pose_leak`` and ``expressed``; ``whose`` are places in
    ``people``, of which each is as likely."""
    which = whose[rng.integers(len(whose), size=count)]
    features = np.empty((count, DIMENSION), np.float32)
    rotations, seen_rotations = np.empty((count, 3), np.float32), np.empty((count, 3), np.float32)
    wanted = np.empty((count, len(channel_indices())), np.float32)
    resting = np.zeros(count, np.bool_)
    acted = np.full((count, people[0].seen.weights.shape[1]), np.nan, np.float32)
    for index, person in enumerate(people):
        rows = np.flatnonzero(which == index)
        picked = rng.integers(len(person.seen), size=len(rows))
        rotations[rows], seen_rotations[rows] = person.seen.rotations[picked], person.seen.seen_rotations[picked]
        features[rows] = person.seen.features[picked] - turned(rotations[rows]) @ leaks[index]
        wanted[rows] = expressions[index][picked]
        resting[rows] = at_rest(person.seen.weights)[picked]
        if people[0].arkit and person.arkit:
            acted[rows] = person.seen.weights[picked]
    spread = np.where(resting, RESTING_LEAK_SPREAD, LEAK_SPREAD).astype(np.float32)
    features += others.of_others(rotations, spread, rng)
    if len(footage):
        rows = rng.random(count) < 1 / 3
        picked = rng.integers(len(footage), size=int(rows.sum()))
        features[rows], seen_rotations[rows] = footage[picked, :DIMENSION], footage[picked, DIMENSION:]
        turn = turned(seen_rotations[rows]) @ others.mean
        wanted[rows] = in_tolerances(features[rows] - turn.astype(np.float32))
        rotations[rows], resting[rows], acted[rows] = seen_rotations[rows], False, np.nan
    differing = _other_mouths(wanted, rng)
    features[:, channel_indices()] += differing * channel_tolerances()
    wanted += differing
    whole = rng.normal(0, GAIN_SPREAD / 2, (count, 1)).astype(np.float32)
    gains = np.exp(whole + rng.normal(0, GAIN_SPREAD, (count, DIMENSION)))
    acted *= np.exp(whole)
    features *= gains
    wanted *= gains[:, channel_indices()]
    for name, spread in NOISE.items():
        features[:, BLOCKS[name]] += rng.normal(0, spread, features[:, BLOCKS[name]].shape)
    return Crowd(features.astype(np.float32), seen_rotations, wanted.astype(np.float32), resting, rotations, acted)


def _other_mouths(wanted: Floats32, rng: np.random.Generator) -> Floats32:
    """[S, T] what to add to read and followed channels [S, T] alike, so that mouths differ from the avatars'."""
    mouth = mouth_channels()
    spread = np.sqrt((wanted[:, mouth] ** 2).mean(0)) + 1e-6
    moved = np.sqrt(((wanted[:, mouth] / spread) ** 2).mean(1, keepdims=True))
    differing = np.zeros_like(wanted)
    differing[:, mouth] = MOUTH_SPREAD * moved * spread * rng.normal(size=(len(wanted), int(mouth.sum())))
    return differing
