"""Which splats may be drawn at all: finite, of sane size, in front of the camera."""

import numba
import numpy as np

from .projection import LOG_SCALE_MAX, LOG_SCALE_MIN, NEAR, POSITION_MAX

_INF = np.float32(np.inf)


@numba.njit(cache=True, inline="always")
def is_sane(position, wxyz, log_scales, logit, color):
    """Whether a raw splat is finite and within the limits of ``projection``. Comparisons with NaN are false, which
    refuses it; the kernels that use this must therefore not be compiled with ``nnan``."""
    length = wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]
    # & and not `and`: without branches several splats are looked at in one instruction
    return (
        (abs(position[0]) <= POSITION_MAX)
        & (abs(position[1]) <= POSITION_MAX)
        & (abs(position[2]) <= POSITION_MAX)
        & (log_scales[0] >= LOG_SCALE_MIN)
        & (log_scales[1] >= LOG_SCALE_MIN)
        & (log_scales[2] >= LOG_SCALE_MIN)
        & (log_scales[0] <= LOG_SCALE_MAX)
        & (log_scales[1] <= LOG_SCALE_MAX)
        & (log_scales[2] <= LOG_SCALE_MAX)
        & (length < _INF)
        & (abs(logit) < _INF)
        & (abs(color[0]) < _INF)
        & (abs(color[1]) < _INF)
        & (abs(color[2]) < _INF)
    )


@numba.njit(cache=True, inline="always")
def view_depth(position, row):
    """Distance from the camera's plane in metres, float64: it decides the order. ``row`` is the third of
    world_to_camera."""
    return row[0] * position[0] + row[1] * position[1] + row[2] * position[2] + row[3]


@numba.njit(cache=True, error_model="numpy")
def view_depths(positions, wxyz, log_scales, logits, colors, row, depths):
    """Write each splat's distance from the camera's plane in metres into ``depths`` [N], 0 where it is not drawn.

    ``row`` is the third of world_to_camera; it and ``depths`` are float64. The arrays are those of RawGaussians.
    """
    for i in range(len(positions)):
        sane = is_sane(positions[i], wxyz[i], log_scales[i], logits[i], colors[i])
        depth = view_depth(positions[i], row)
        depths[i] = depth if sane & (depth >= NEAR) else 0.0
