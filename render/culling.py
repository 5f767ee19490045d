"""Which splats may be drawn at all: finite, of sane size, in front of the camera."""

import numba
import numpy as np

from .projection import LOG_SCALE_MAX, LOG_SCALE_MIN, NEAR, POSITION_MAX

_INF = np.float32(np.inf)


@numba.njit(cache=True, inline="always")
def is_sane(position, wxyz, log_scales, logit):
    """Whether a raw splat is finite and within the limits of ``projection``. Comparisons with NaN are false, which
    refuses it; the kernels that use this must therefore not be compiled with ``nnan``."""
    length = wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]
    return (
        abs(position[0]) <= POSITION_MAX
        and abs(position[1]) <= POSITION_MAX
        and abs(position[2]) <= POSITION_MAX
        and log_scales[0] >= LOG_SCALE_MIN
        and log_scales[1] >= LOG_SCALE_MIN
        and log_scales[2] >= LOG_SCALE_MIN
        and log_scales[0] <= LOG_SCALE_MAX
        and log_scales[1] <= LOG_SCALE_MAX
        and log_scales[2] <= LOG_SCALE_MAX
        and length < _INF
        and abs(logit) < _INF
    )


@numba.njit(cache=True, error_model="numpy")
def view_depths(positions, wxyz, log_scales, logits, matrix, depths):
    """Write each splat's distance from the camera's plane in metres into ``depths`` [N], 0 where it is not drawn.

    ``matrix`` [4, 4] float32 is world_to_camera; the arrays are those of RawGaussians.
    """
    for i in range(len(positions)):
        depths[i] = 0
        if is_sane(positions[i], wxyz[i], log_scales[i], logits[i]):
            p = positions[i]
            z = matrix[2, 0] * p[0] + matrix[2, 1] * p[1] + matrix[2, 2] * p[2] + matrix[2, 3]
            if z >= NEAR:
                depths[i] = z
