"""Heads whose origin nobody told: moved so that crown and sides lie where the canonical head's do."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...render.gaussians import RawGaussians
from ..gem import Viewing
from .foreign import ForeignFormatError
from .neck import CHIN
from .splatply import LOG_SCALE_LIMITS

HEAD_HEIGHT = 0.25
"""Chin to crown, hair included, metres; what the splats themselves do not tell."""
VIEWING = Viewing((0.0, CHIN + HEAD_HEIGHT / 2, 0.02), HEAD_HEIGHT)
"""Of a head that was moved by ``canonical_shift``."""
_SIZES = (0.15, 2.0)
"""Metres: how high heads are, with all that is below them."""
_SCALE_CURE = "give --scale, the metres of one of its units"


def scaled(raw: RawGaussians, scale: float) -> RawGaussians:
    """Splats in other units: ``scale`` metres are one of theirs."""
    if scale == 1:
        return raw
    log_scales = np.clip(raw.log_scales + np.float32(np.log(scale)), *LOG_SCALE_LIMITS)
    return replace(raw, positions=raw.positions * np.float32(scale), log_scales=log_scales)


def canonical_shift(raw: RawGaussians, where: Path) -> NDArray[np.float32]:
    """[3] metres to move a head by, y up and looking along +z, whose chin is HEAD_HEIGHT below its crown.

    Raises ForeignFormatError, naming ``where``, for what is no head by its size.
    """
    solid = raw.opacity_logits > 0
    points = raw.positions[solid if solid.any() else slice(None)]
    low, high = np.percentile(points, [0.5, 99.8], axis=0)
    if not _SIZES[0] <= high[1] - low[1] <= _SIZES[1]:
        raise ForeignFormatError(where, f"its splats are {high[1] - low[1]:.3g} m high, no head is", _SCALE_CURE)
    head = points[points[:, 1] > high[1] - HEAD_HEIGHT]
    middle = (np.percentile(head, 1, axis=0) + np.percentile(head, 99, axis=0)) / 2
    # crown and sides of the head go where the canonical ones are; its depth is told by nose and nape
    return np.array([-middle[0], CHIN + HEAD_HEIGHT - high[1], -middle[2]], np.float32)
