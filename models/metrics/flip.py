"""FLIP (Andersson et al. 2020): what a person notices who flips between two pictures. Needs ``flip-evaluator``."""

import numpy as np
from numpy.typing import NDArray

PIXELS_PER_DEGREE = 67.0
"""A 0.7 m wide 4K screen seen from 0.7 m, the published default."""


def flip_map(image: NDArray[np.floating], target: NDArray[np.floating]) -> NDArray[np.float32] | None:
    """[H, W] of two sRGB pictures [H, W, 3] in [0, 1]: 0 for no visible difference, 1 for the greatest.

    None where the package ``flip-evaluator`` is not installed (it comes with ``gemheads[train]``).
    """
    try:
        import flip_evaluator
    except ImportError:
        return None
    reference, test = (np.ascontiguousarray(np.clip(p, 0, 1), np.float32) for p in (target, image))
    found, _, _ = flip_evaluator.evaluate(
        reference, test, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE}
    )
    return np.asarray(found, np.float32)[..., 0]
