"""The geometric median: the middle of points in space, which outliers cannot drag along."""

import numpy as np
from numpy.typing import NDArray

STEPS = 1000
CLOSE = 1e-7
"""Relative change at which the search ends."""


def geometric_median(points: NDArray[np.floating]) -> NDArray[np.float64]:
    """[D] the point with the least sum of distances to ``points`` [n, D], n >= 1.

    Weiszfeld's iteration, with the step of Vardi and Zhang ("The multivariate L1-median and associated data depth",
    PNAS 97, 2000) where it meets one of the points.
    """
    points = np.asarray(points, np.float64)
    middle = np.median(points, axis=0)
    extent = float(np.abs(points - middle).max())
    for _ in range(STEPS):
        distances = np.linalg.norm(points - middle, axis=1)
        here = distances <= CLOSE * max(extent, 1e-300)
        if here.all():
            return middle
        weights = 1 / distances[~here]
        towards = (points[~here] * weights[:, None]).sum(0) / weights.sum()
        pull = float(np.linalg.norm(((points[~here] - middle) * weights[:, None]).sum(0)))
        held = min(1.0, here.sum() / pull) if pull > 0 else 1.0
        step = (1 - held) * (towards - middle)
        middle = middle + step
        if np.linalg.norm(step) <= CLOSE * extent:
            return middle
    return middle
