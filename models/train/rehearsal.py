"""Pictures of an avatar at what its regressor answers: random faces say little of the few that it will be asked for.

A network that is trained against a model of the avatar's response finds the faces at which the model errs. Drawn and
read, they correct it.
"""

from collections.abc import Callable

import numpy as np
import torch

from ..gem import Gem
from .controls import Controls
from .network import RegressorNetwork
from .response import Responses, measure_responses
from .strangers import Crowd

FRONTAL_SHARE = 0.4
"""So many are drawn from the front, where answers are compared."""
UNREST, UNREST_SHARE = 0.06, 0.7
"""Standard deviation by which weights are moved, and in how many pictures: what leads away from an answer must be
known, too."""


def rehearse(
    gem: Gem,
    controls: Controls,
    network: RegressorNetwork,
    people: Crowd,
    rng: np.random.Generator,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Responses:
    """Draws and reads the avatar as it would follow each moment of ``people``. Raises AvatarNotSeen."""
    with torch.no_grad():
        answers = network.weights(torch.from_numpy(people.features), torch.from_numpy(people.rotations)).numpy()
    moved = rng.random((len(people), 1)) < UNREST_SHARE
    answers = answers + moved * rng.normal(0, UNREST, answers.shape)
    weights = np.clip(answers, controls.lower, controls.upper).astype(np.float32)
    rotations = people.rotations.copy()
    rotations[rng.random(len(people)) < FRONTAL_SHARE] = 0
    return measure_responses(gem, controls, weights, rng, progress, rotations)
