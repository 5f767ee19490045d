"""Trains the regressor of one avatar by closing the loop: what is read on a person shall be read on the avatar.

F, the avatar's response, is learned first: control weights to tracked channels, from pictures of the avatar. The
regressor g is then trained on relative features r of avatars and invented people (no labels) so that F(g(r)) matches r.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ..driver.features import BLOCKS
from ..gem import Gem
from ..gemfile import load_gem, read_info, save_gem
from .channels import channel_indices, channel_tolerances
from .closing import ClosedLoop, descend
from .controls import Controls, controls_of
from .export_onnx import export_onnx
from .expressions import random_coefficients, random_weights
from .footage import read_footage
from .network import FeaturePca, RegressorNetwork
from .response import ResponseModel, Responses, fit_response, measure_responses
from .strangers import crowd

COMPONENTS = 50
"""Equation 3: the features are reduced to so many numbers."""
SIGMA_FLOOR = 1e-3
"""Principal directions with a smaller share of the first one's spread are not whitened, they are dropped."""
Progress = Callable[[str, int, int], None]


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
    out: Path | None = None,
    *,
    companions: Sequence[Path] = (),
    videos: Sequence[Path] = (),
    pictures: int = 6000,
    steps: int = 8000,
    seed: int = 0,
    progress: Progress = lambda stage, done, total: None,
) -> TrainingReport:
    """Trains a regressor for ``avatar`` and saves the avatar with it.

    Args:
        avatar: a .gem file.
        out: where the result goes; None replaces ``avatar``.
        companions: other avatars, which play strangers.
        videos: any videos of faces, unlabelled; they need not be of one person.
        pictures: how many pictures of the avatar are drawn and read.
        steps: training steps of the response model and of the regressor each.
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
    save_gem(replace(gem, regressor=regressor), out or avatar, basis=read_info(avatar).card.basis)
    return report


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
    controls = controls_of(gem)
    own = _pictured(gem, controls, pictures, rng, lambda done, total: progress("pictures", done, total))
    others = [
        _pictured(
            other,
            controls_of(other),
            max(200, pictures // 4),
            rng,
            lambda done, total: progress("strangers", done, total),
        )
        for other in companions
    ]
    response, r2 = response_of(own, steps, seed)
    people = crowd([own, *others], footage, 40_000, rng)
    judges = crowd([own, *others], footage, 2_000, rng)
    pca = feature_pca(np.concatenate([own.features, people.features[:8000]]))
    torch.manual_seed(seed)
    network = RegressorNetwork(pca, controls)
    loop = ClosedLoop(network, response, own, people)
    before = loop.mismatch(judges)
    descend(network, lambda _: loop.loss(), steps, progress)
    return export_onnx(network), TrainingReport(len(own), r2, before, loop.mismatch(judges))


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


def _pictured(
    gem: Gem, controls: Controls, count: int, rng: np.random.Generator, progress: Callable[[int, int], None]
) -> Responses:
    weights = random_coefficients(controls, count, rng) if gem.arkit_weights is None else random_weights(count, rng)
    return measure_responses(gem, controls, weights, rng, progress)


def pictures_of(gem: Gem, count: int, seed: int, progress: Progress = lambda stage, done, total: None) -> Responses:
    """So many pictures of an avatar that plays a stranger, as the tracker reads them. Raises AvatarNotSeen."""
    rng = np.random.default_rng(seed)
    return _pictured(gem, controls_of(gem), count, rng, lambda done, total: progress("strangers", done, total))


def response_of(own: Responses, steps: int, seed: int) -> tuple[ResponseModel, float]:
    """F of an avatar from its pictures, and the share of variance that it explains."""
    channels = own.features[:, channel_indices()] / channel_tolerances()
    inputs = (torch.from_numpy(own.weights), torch.from_numpy(own.rotations))
    return fit_response(inputs, torch.from_numpy(channels), steps, seed)
