"""How a regressor sees relative features: a few numbers instead of all.

A capture's regressor gets the paper's principal components. They are directions in which one person's pictures differ
most, and nearly all of a face mesh moves with them; on people never seen what is compared drowns in what is not. A
regressor that closes the loop gets the compared channels themselves, and needs to invert the avatar's response only.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...driver.features import BLOCKS, DIMENSION
from .channels import channel_indices

COMPONENTS = 50
"""Equation 3: the features are reduced to so many numbers."""
SIGMA_FLOOR = 1e-3
"""Principal directions with a smaller share of the first one's spread are not whitened, they are dropped."""
CHANNEL_FLOOR = 1e-3
"""Least standard deviation by which a channel, or a block of them, is divided, in its own unit: what never differs is
not stretched."""


@dataclass(frozen=True)
class Reduction:
    """kappa = (r - mean) @ projection, each of its P numbers with a standard deviation of one."""

    mean: NDArray[np.float32]
    """[D] mean relative feature."""
    projection: NDArray[np.float32]
    """[D, P] directions, each divided by the standard deviation along it."""


def principal_components(features: NDArray[np.float32]) -> Reduction:
    """Equation 3 on relative features [S, D], every block that differs scaled to the same spread.

    Raises ValueError where no two of the S differ.
    """
    spreads = {name: float(np.sqrt(features[:, block].var(0).sum())) for name, block in BLOCKS.items()}
    if max(spreads.values()) < CHANNEL_FLOOR:
        raise ValueError(
            f"the faces in {len(features)} pictures do not differ: nothing can be learned of them; give more moments"
        )
    scale = np.ones(features.shape[1])
    for name, block in BLOCKS.items():
        scale[block] = max(spreads[name], CHANNEL_FLOOR)
    mean = features.mean(0)
    _, spread, directions = np.linalg.svd((features - mean) / scale, full_matrices=False)
    kept = min(COMPONENTS, int(np.count_nonzero(spread > SIGMA_FLOOR * spread[0])))
    sigma = spread[:kept] / np.sqrt(len(features) - 1)
    return Reduction(mean.astype(np.float32), (directions[:kept] / scale / sigma[:, None]).T.astype(np.float32))


def compared_channels(features: NDArray[np.float32]) -> Reduction:
    """The channels that training compares (``channels.channel_indices``), of relative features [S, D]."""
    places = channel_indices()
    spread = features[:, places].std(0)
    projection = np.zeros((DIMENSION, len(places)), np.float32)
    projection[places, np.arange(len(places))] = 1 / np.maximum(spread, CHANNEL_FLOOR)
    return Reduction(features.mean(0).astype(np.float32), projection)
