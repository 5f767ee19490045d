"""Which way a surface faces that is finer than its triangles: pores and folds of the skin, the cornea of an eye."""

import numba

from .mixing import dot, unit
from .raster import sampled

PORE_M = 0.10e-3
"""Height of the skin's pores, from their mean to the top."""
FOLD_M = 0.55e-3
"""Depth of the deepest line where the skin is compressed most."""
CORNEA_BULGE = 0.42
"""How far in front of the eyeball's centre the cornea's is, in eyeball radii."""
CORNEA_COS = 0.86


@numba.njit(cache=True, inline="always")
def skin_normal(spot, slopes, detail, fold):
    """The normal where pores rise and the skin is folded.

    Args:
        spot: a place on skin.
        slopes: [2, 3] gradients of u and v along its triangle, 1/m.
        detail: the map of ``Subject``.
        fold: how much the skin is compressed here.
    """
    u, v, normal, texel = spot.u, spot.v, spot.normal, 1.0 / detail.shape[0]
    du = (sampled(detail, u + texel, v, 2) - sampled(detail, u - texel, v, 2)) * PORE_M
    dv = (sampled(detail, u, v + texel, 2) - sampled(detail, u, v - texel, 2)) * PORE_M
    du -= (sampled(detail, u + texel, v, 1) - sampled(detail, u - texel, v, 1)) * FOLD_M * fold
    dv -= (sampled(detail, u, v + texel, 1) - sampled(detail, u, v - texel, 1)) * FOLD_M * fold
    du, dv = du / (2 * texel), dv / (2 * texel)
    bent = (
        normal[0] - (du * slopes[0, 0] + dv * slopes[1, 0]),
        normal[1] - (du * slopes[0, 1] + dv * slopes[1, 1]),
        normal[2] - (du * slopes[0, 2] + dv * slopes[1, 2]),
    )
    return unit(bent, 1e-9)


@numba.njit(cache=True, inline="always")
def eye_normal(point, eye):
    """The normal of an eyeball with its cornea. ``eye`` [7]: its middle, where it looks, its radius."""
    axis = eye[3], eye[4], eye[5]
    away = point[0] - eye[0], point[1] - eye[1], point[2] - eye[2]
    off = dot(unit(away, 1e-9), axis)
    blend = min(max((off - CORNEA_COS) / 0.06, 0.0), 1.0)
    shift = CORNEA_BULGE * eye[6] * blend
    return unit((away[0] - shift * axis[0], away[1] - shift * axis[1], away[2] - shift * axis[2]), 1e-9)
