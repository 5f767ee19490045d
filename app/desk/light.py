"""The light on the avatar: a factor on the colours of its splats, so that the ground stays as it is. Pure."""

import numpy as np
from numpy.typing import NDArray

GAMMA = 2.2
"""sRGB-encoded values grow with about the 2.2th root of the light."""
WARM_STOPS = np.array([0.35, 0.0, -0.35])
"""What full warmth adds to red, green and blue, in stops."""


def lit(colors: NDArray[np.float32], exposure: float, warmth: float) -> NDArray[np.float32]:
    """Colours [N, 3] in [0, 1] under ``exposure`` stops more light, ``warmth`` in -1 (cold) to 1 (warm).

    It is one lamp for the whole head, from where the light in the colours comes: no shadow moves.
    """
    if exposure == 0 and warmth == 0:
        return colors
    factor = 2.0 ** ((exposure + warmth * WARM_STOPS) / GAMMA)
    return np.clip(colors * factor.astype(np.float32), 0, 1)
