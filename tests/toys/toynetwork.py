"""A regressor of random weights, for tests that train nothing, and features for it to read."""

import numpy as np
import pytest
from gemheads.models.driver.features import DIMENSION

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.controls import Controls  # noqa: E402
from gemheads.models.train.regressors.network import RegressorNetwork  # noqa: E402
from gemheads.models.train.regressors.reduction import principal_components  # noqa: E402


def relative_features(count: int, seed: int = 0) -> np.ndarray:
    return (np.random.default_rng(seed).normal(size=(count, DIMENSION)) * 0.1).astype("f4")


def network_of(controls: Controls, trained: bool = True) -> RegressorNetwork:
    torch.manual_seed(0)
    network = RegressorNetwork(principal_components(relative_features(300)), controls)
    if trained:
        with torch.no_grad():
            for parameter in network.parameters():
                parameter.add_(0.2 * torch.randn_like(parameter))
            for learned in (*network.parameters(), network.projection):  # as a file keeps them
                learned.copy_(learned.half())
    return network
