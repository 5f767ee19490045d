"""Trains the regressor of one avatar by closing the loop: what is read on a person shall be read on the avatar.

F, an avatar's response, is learned first: control weights to tracked channels, from pictures of the avatar. The
regressor g is then trained on relative features r of avatars and invented people (no labels) so that F(g(r)) matches r.
In between it acts before the tracker: F is learned again with these pictures, too, and g goes on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ..driver.features import BLOCKS
from ..gem import Gem
from ..gemfile import load_gem
from .closing import ClosedLoop, descend
from .controls import controls_of
from .export_onnx import export_onnx
from .expressions import random_coefficients, random_weights
from .footage import read_footage
from .network import FeaturePca, RegressorNetwork
from .rehearsal import rehearse
from .response import Responses, fit_response, joined, measure_responses
from .strangers import Person, crowd, in_tolerances

COMPONENTS = 50
"""Equation 3: the features are reduced to so many numbers."""
SIGMA_FLOOR = 1e-3
"""Principal directions with a smaller share of the first one's spread are not whitened, they are dropped."""
CROWD = 40_000
"""Moments of invented people to follow."""
FIRST_ACT = 0.35
"""After this share of the steps the avatar acts what it has learned ..."""
REHEARSED = 0.4
"""... in so many pictures, against the random ones."""
STRANGERS = 0.6
"""Pictures of each companion, against the random ones of the avatar."""
RESPONSE_SHARE = 0.35
"""Steps of each response, against those of the regressor."""
SERIES = 500
"""Pictures are drawn in series of so many, each with random numbers of its own."""
Progress = Callable[[str, int, int], None]


def _silent(done: int, total: int) -> None:
    """Tells nobody."""


@dataclass(frozen=True)
class TrainingReport:
    """What a training reached."""

    pictures: int
    """Pictures of the avatar that its response was learned from."""
    response_r2: float
    """Share of the channels' variance that the response model explains on pictures it never saw."""
    start_mismatch: float
    """Mean mismatch between people and avatar, in tolerances, by the unlearned start ..."""
    end_mismatch: float
    """... and by the trained regressor, on moments of invented people held out of training."""


def train_regressor(
    avatar: Path,
    *,
    companions: Sequence[Path] = (),
    videos: Sequence[Path] = (),
    pictures: int = 2500,
    steps: int = 6000,
    seed: int = 0,
    progress: Progress = lambda stage, done, total: None,
) -> tuple[Gem, TrainingReport]:
    """Trains a regressor for ``avatar``, and gives the avatar with it.

    Args:
        avatar: a .gem file.
        companions: other avatars, which play strangers.
        videos: any videos of faces, unlabelled; they need not be of one person.
        pictures: how many pictures of the avatar with random faces are drawn and read, besides those of what it has
            learned; of companions fewer.
        steps: training steps of the regressor.
        seed: makes the run repeatable.
        progress: called with the stage's name, steps done and steps in all.

    Raises:
        GemFormatError: for a file that is no avatar.
        AvatarNotSeen: where the tracker finds no face in the avatar's picture.
    """
    gem = load_gem(avatar)
    regressor, report = regressor_for(
        gem,
        [load_gem(path) for path in companions],
        read_footage(videos, lambda done, total: progress("videos", done, total)),
        pictures=pictures,
        steps=steps,
        seed=seed,
        progress=progress,
    )
    return replace(gem, regressor=regressor), report


def regressor_for(
    gem: Gem,
    companions: Sequence[Gem],
    footage: NDArray[np.float32],
    *,
    pictures: int,
    steps: int,
    seed: int,
    progress: Progress = lambda stage, done, total: None,
) -> tuple[bytes, TrainingReport]:
    """The ONNX graph of a regressor for ``gem``, and how well it does. ``footage`` as read_footage gives it."""
    rng = np.random.default_rng(seed)
    controls, fit_steps = controls_of(gem), max(1, int(steps * RESPONSE_SHARE))
    own = pictures_of(gem, pictures, seed, lambda done, total: progress("pictures", done, total))
    avatar, r2 = person_of(own, fit_steps, seed)
    others = []
    for other in companions:
        seen = pictures_of(
            other, max(200, int(pictures * STRANGERS)), seed, lambda done, total: progress("strangers", done, total)
        )
        others.append(person_of(seen, fit_steps, seed)[0])
    people = crowd([avatar, *others], footage, CROWD, rng)
    torch.manual_seed(seed)
    network = RegressorNetwork(feature_pca(np.concatenate([own.features, people.features[:8000]])), controls)
    loop = ClosedLoop(network, avatar, people)
    before = loop.mismatch(crowd([avatar, *others], footage, CROWD // 20, rng))
    first = max(1, int(steps * FIRST_ACT))
    descend(network, loop.loss, first, progress)
    audience = crowd([avatar, *others], footage, max(1, int(pictures * REHEARSED)), rng)
    acted = rehearse(gem, controls, network, audience, rng, lambda done, total: progress("rehearsal", done, total))
    own = joined([own, acted])
    avatar, r2 = person_of(own, fit_steps, seed)
    loop = ClosedLoop(network, avatar, crowd([avatar, *others], footage, CROWD, rng))
    descend(network, loop.loss, max(1, steps - first), progress)
    after = loop.mismatch(crowd([avatar, *others], footage, CROWD // 20, rng))
    return export_onnx(network), TrainingReport(len(own), r2, before, after)


def feature_pca(features: NDArray[np.float32]) -> FeaturePca:
    """Equation 3 on relative features [S, D], every block scaled to the same spread."""
    scale = np.ones(features.shape[1])
    for block in BLOCKS.values():
        scale[block] = np.sqrt(features[:, block].var(0).sum())
    mean = features.mean(0)
    _, spread, directions = np.linalg.svd((features - mean) / scale, full_matrices=False)
    kept = min(COMPONENTS, int(np.count_nonzero(spread > SIGMA_FLOOR * spread[0])))
    sigma = spread[:kept] / np.sqrt(len(features) - 1)
    return FeaturePca(mean.astype(np.float32), (directions[:kept] / scale / sigma[:, None]).T.astype(np.float32))


def pictures_of(gem: Gem, count: int, seed: int, progress: Callable[[int, int], None] = _silent) -> Responses:
    """``count`` pictures of an avatar with random faces, as the tracker reads them; fewer where no face is seen.

    Whole series are the same in however many pictures. Raises AvatarNotSeen.
    """

    def advance(first: int, done: int, _: int) -> None:
        progress(first + done, count)

    controls = controls_of(gem)
    parts: list[Responses] = []
    for first in range(0, count, SERIES):
        rng = np.random.default_rng([seed, first])
        weights = (
            random_coefficients(controls, SERIES, rng) if gem.arkit_weights is None else random_weights(SERIES, rng)
        )
        weights = weights[: count - first]
        parts.append(measure_responses(gem, controls, weights, rng, partial(advance, first)))
    return joined(parts)


def person_of(seen: Responses, steps: int, seed: int) -> tuple[Person, float]:
    """An avatar with its response F, learned from its pictures, and the share of variance that F explains."""
    inputs = (torch.from_numpy(seen.weights), torch.from_numpy(seen.rotations))
    response, r2 = fit_response(inputs, torch.from_numpy(in_tolerances(seen.features)), steps, seed)
    return Person(seen, response), r2
