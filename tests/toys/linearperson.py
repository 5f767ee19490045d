"""Somebody whose features follow weights and head rotation linearly, so that tests can tell what should be read."""

import numpy as np
import pytest
from gemheads.models.arkit import NAMES

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.channels import channel_indices  # noqa: E402
from gemheads.models.train.regressors.expressions import random_weights  # noqa: E402
from gemheads.models.train.regressors.response import TYPICAL, ResponseModel, Responses  # noqa: E402
from gemheads.models.train.regressors.strangers import Person, in_tolerances  # noqa: E402


def linear_person(shapes: np.ndarray, leak: np.ndarray, count: int = 1500, seed: int = 0) -> Person:
    """Whose features are ``weights @ shapes + rotations @ leak``, with a response that knows it."""
    rng = np.random.default_rng(seed)
    weights, rotations = random_weights(count, rng), rng.normal(0, 0.2, (count, 3)).astype("f4")
    response = ResponseModel(len(NAMES), len(channel_indices()))
    last = response.bend[-1]
    assert isinstance(last, torch.nn.Linear)
    with torch.no_grad():
        last.weight.zero_()
        last.bias.zero_()
        seen = np.concatenate([shapes, leak * TYPICAL])  # it reads rotations in that unit
        response.linear.weight.copy_(torch.from_numpy(in_tolerances(seen.astype("f4")).T))
        response.linear.bias.zero_()
    response.requires_grad_(False)
    features = (weights @ shapes + rotations @ leak).astype("f4")
    return Person(Responses(weights, rotations, rotations, features), response)
