"""Differences pixel by pixel. Pictures are [H, W, C] floats in [0, 1]; a mask [H, W] in [0, 1] weighs the pixels."""

import numpy as np

from ...render.arrays import Floats

BEST_DB = 120.0
"""What equal pictures are given, instead of infinity."""


def l1(image: Floats, target: Floats, mask: Floats | None = None) -> float:
    """Mean absolute difference, in [0, 1]; smaller is better. Tables 1 and 2 of the paper."""
    return weighed(np.abs(_difference(image, target)), mask)


def psnr(image: Floats, target: Floats, mask: Floats | None = None) -> float:
    """Decibels of a peak of 1 over the mean squared difference; larger is better, BEST_DB at most."""
    error = weighed(_difference(image, target) ** 2, mask)
    return min(BEST_DB, -10 * float(np.log10(max(error, 1e-30))))


def weighed(values: Floats, mask: Floats | None) -> float:
    """The mean of a map [H, W, C] over its pixels, each as much as ``mask`` [H, W] says.

    Raises ValueError for a mask of another size, or one that leaves nothing.
    """
    if mask is None:
        return float(np.mean(values, dtype=np.float64))
    if mask.shape != values.shape[:2]:
        raise ValueError(f"the mask is {mask.shape}, the picture {values.shape[:2]}")
    weight = float(np.sum(mask, dtype=np.float64))
    if not weight > 0:
        raise ValueError("the mask leaves no pixel to compare")
    return float(np.sum(values.mean(-1) * mask, dtype=np.float64)) / weight


def _difference(image: Floats, target: Floats) -> Floats:
    if image.shape != target.shape or image.ndim != 3:
        raise ValueError(f"two pictures [H, W, C] of one size are compared, got {image.shape} and {target.shape}")
    return image.astype(np.float64) - target
