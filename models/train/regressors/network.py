"""The regressor as a torch module, and its twin that ships: one ONNX graph (equations 3 and 4 of the paper)."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from ...driver.features import DIMENSION, SCORES
from .controls import UNBOUNDED, Controls
from .leaks import FACTORS, TERMS
from .reduction import Reduction
from .response import TYPICAL

HIDDEN = 256
KAPPA_LIMIT = 4.0
"""kappa is clipped here, in sigmas: a face far outside the training set must not reach the network as a huge number."""
TURN_LIMIT = 8.0
"""The same for rotations in units of TYPICAL, their squares and products: beyond 32 degrees all squares are alike."""
FACING = 0.05
"""Radians: who turns his head by no more faces the camera, and what is read on him is no pose leak. Networks see
rotations up to here once more, in this unit; in radians alone, where they are small, half a pucker from the front was
doubted as if the head had turned."""


class RegressorNetwork(nn.Module):
    """Relative features r [B, D] and head rotation [B, 3] (radians) to control weights, and on to coefficients.

    weights = clip(start(r) + reach tanh(MLP(kappa, turn)[leaders]))
    k = 3 sigma f((rest + weights @ to_coefficients) / (3 sigma))

    f is tanh (equation 4) for coefficients; for ARKit weights it begins to bend at ``controls.STRAIGHT``.

    turn: the rotation near the front, and as far as it goes with its squares and products, like pose leak (``leaks``).

    ``start`` is the unlearned reading of the scores, so that an untrained network already drives.
    """

    feature_mean: Tensor
    projection: Tensor
    start: Tensor
    least: Tensor
    lower: Tensor
    upper: Tensor
    reach: Tensor
    rest: Tensor
    to_coefficients: Tensor
    limit: Tensor
    straight: Tensor
    pairs: Tensor
    leaders: Tensor
    first: Tensor
    second: Tensor

    def __init__(self, reduction: Reduction, controls: Controls) -> None:
        super().__init__()

        def constant(name: str, array: NDArray[np.floating]) -> None:
            self.register_buffer(name, torch.tensor(np.asarray(array, np.float32)))

        constant("feature_mean", reduction.mean)
        constant("projection", reduction.projection)
        constant("start", controls.start)
        constant("least", np.full(DIMENSION, UNBOUNDED))
        self.least[SCORES] = torch.from_numpy(controls.least)
        constant("lower", controls.lower)
        constant("upper", controls.upper)
        constant("reach", controls.reach)
        constant("rest", controls.rest)
        constant("to_coefficients", controls.to_coefficients)
        constant("limit", controls.limit)
        constant("straight", np.array(controls.straight))
        self.register_buffer("pairs", torch.from_numpy(controls.pairs))
        self.register_buffer("leaders", torch.from_numpy(controls.leaders))
        constant("first", FACTORS[0])
        constant("second", FACTORS[1])
        inputs = reduction.projection.shape[1] + 3 + TERMS + len(controls.lower)
        self.layers = nn.Sequential(
            nn.Linear(inputs, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, len(controls.lower)),
        )
        last = self.layers[-1]
        assert isinstance(last, nn.Linear)
        nn.init.zeros_(last.weight)
        nn.init.zeros_(last.bias)

    def inputs(self, features: Tensor, rotation: Tensor) -> tuple[Tensor, Tensor]:
        """What the layers read [B, I], and the unlearned control weights [B, E] that they move; nothing in them is
        learned, so that training needs them only once."""
        features = torch.maximum(features, self.least)
        kappa = ((features - self.feature_mean) @ self.projection).clamp(-KAPPA_LIMIT, KAPPA_LIMIT)
        start = self.started(features)
        return torch.cat([kappa, self.turn(rotation), start], 1), start

    def turn(self, rotation: Tensor) -> Tensor:
        """[B, 3 + TERMS] how layers read the head's rotation [B, 3]."""
        facing = (rotation / FACING).clamp(-1, 1)
        wide = rotation / TYPICAL
        products = (wide @ self.first) * (wide @ self.second)
        return torch.cat([facing, torch.cat([wide, products], 1).clamp(-TURN_LIMIT, TURN_LIMIT)], 1)

    def steered(self, inputs: Tensor, start: Tensor) -> Tensor:
        """Control weights [B, E] before they are clipped to their bounds (training pulls the excess back)."""
        return self.moved(start, self.layers(inputs))

    def moved(self, start: Tensor, ways: Tensor) -> Tensor:
        """The unlearned control weights [B, E], moved by what the layers say [B, E]: by all of the reach at most."""
        return start + self.reach * torch.tanh(ways[:, self.leaders])

    def weights(self, features: Tensor, rotation: Tensor) -> Tensor:
        """Control weights [B, E] within their bounds."""
        return self.bounded(self.steered(*self.inputs(features, rotation)))

    def started(self, features: Tensor) -> Tensor:
        """Control weights [B, E] as the scores alone give them."""
        return self.bounded(features[:, SCORES] @ self.start)

    def bounded(self, weights: Tensor) -> Tensor:
        """Weights [B, E] clipped to their bounds."""
        return torch.minimum(torch.maximum(weights, self.lower), self.upper)

    def forward(self, features: Tensor, rotation: Tensor) -> Tensor:
        """Coefficients [B, coefficients], inside +-3 sigma."""
        free = (self.rest + self.weights(features, rotation) @ self.to_coefficients) / self.limit
        core, left = free.clamp(-self.straight, self.straight), 1 - self.straight
        return self.limit * (core + left * torch.tanh((free - core) / left))
