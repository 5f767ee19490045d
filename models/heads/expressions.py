"""ARKit weights by name."""

import numpy as np
from numpy.typing import NDArray

from ..arkit import NAMES


def weights_of(**named: float) -> NDArray[np.float32]:
    """Weights [52]; a name without its Left or Right means both sides.

    Raises ValueError for a name that ARKit does not have.
    """
    weights = np.zeros(len(NAMES), np.float32)
    for name, value in named.items():
        sides = [name] if name in NAMES else [f"{name}Left", f"{name}Right"]
        for side in sides:
            if side not in NAMES:
                raise ValueError(f"{name!r} is no ARKit weight; they are listed in models/arkit.py")
            weights[NAMES.index(side)] = value
    return weights
