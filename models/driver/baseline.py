"""The driver that learns nothing: relative scores become ARKit weights."""

import numpy as np
from numpy.typing import NDArray

from .. import arkit
from .features import SCORE_NAMES, SCORES

GAIN = 1.15
"""Scores of a full expression stay a little under one."""
_TARGET = np.array([arkit.NAMES.index(name) for name in SCORE_NAMES])


def baseline_weights(relative_features: NDArray[np.floating]) -> NDArray[np.float32]:
    """ARKit weights [..., 52] in [0, 1], order of ``arkit.NAMES``, of relative features [..., D].

    The shapes without a live score stay 0. Feed ``Gem.arkit_coefficients`` with them.
    """
    weights = np.zeros((*relative_features.shape[:-1], len(arkit.NAMES)), np.float32)
    weights[..., _TARGET] = np.clip(GAIN * relative_features[..., SCORES], 0, 1)
    return weights
