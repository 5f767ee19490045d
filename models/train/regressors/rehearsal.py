"""Pictures of an avatar at what it shall answer people: random faces say little of the few that it will be asked for.

What is best by a model of the avatar's response is often where the model errs. Drawn and read, that corrects it.
"""

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from ...driver.regressor import Regressor
from ...gem import Gem
from ..workers import ALONE, Workers
from .controls import Controls
from .network import RegressorNetwork
from .response import ITSELF, Responses, Sitting
from .series import draw_series, in_series
from .strangers import Crowd

FRONTAL_SHARE = 0.4
"""So many are drawn from the front, as most people sit before their cameras."""
UNREST, UNREST_SHARE = 0.06, 0.7
"""Standard deviation by which weights are moved, and in how many pictures: what leads away from an answer must be
known, too."""


def answers_of(network: RegressorNetwork, people: Crowd) -> NDArray[np.float32]:
    """[S, E] control weights that a network gives each moment of ``people``."""
    with torch.no_grad():
        return network.weights(torch.from_numpy(people.features), torch.from_numpy(people.rotations)).numpy()


def remembered(regressor: Regressor, controls: Controls, people: Crowd) -> NDArray[np.float32]:
    """[S, E] control weights that the regressor which an avatar has gives each moment of ``people``."""
    moments = zip(people.features, people.rotations, strict=True)
    return controls.weights(np.stack([regressor(features, rotation).coefficients for features, rotation in moments]))


def rehearse(
    gem: Gem,
    controls: Controls,
    answers: NDArray[np.float32],
    people: Crowd,
    rng: np.random.Generator,
    progress: Callable[[int, int], None] = lambda done, total: None,
    workers: Workers = ALONE,
    sitting: Sitting = ITSELF,
) -> Responses:
    """Draws and reads the avatar as it follows each moment of ``people`` with ``answers`` [S, E]. Raises
    AvatarNotSeen, WorkerLost."""
    moved = rng.random((len(people), 1)) < UNREST_SHARE
    played = answers + moved * rng.normal(0, UNREST, answers.shape)
    weights = np.clip(played, controls.lower, controls.upper).astype(np.float32)
    rotations = people.rotations.copy()
    rotations[rng.random(len(people)) < FRONTAL_SHARE] = 0
    return draw_series(gem, controls, in_series(weights, rng, rotations, sitting), progress, workers)
