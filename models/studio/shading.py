"""The colour of every sample: light under and on the skin, wet eyes, hair, and what folds do to them."""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from ..heads.subjectfile import EYES_PART_U
from .bending import eye_normal, skin_normal
from .mirroring import gleam, glint, mirror, reflected
from .mixing import Spot, dot, mixed, mixed_vector, unit
from .raster import sampled

EXPOSURE = 0.95
FOLD_DARKENS = 0.42
SKIN_F0, EYE_F0, TOOTH_F0 = 0.028, 0.025, 0.045
ROUGH = (0.30, 0.16)
"""The two lobes of skin, GGX's alpha."""
OILY = 3.0
EYE_ROUGH, TOOTH_ROUGH = 0.03, 0.12
SHOULDER, SOFT = 0.70, 0.45
SKIN, EYES, TEETH, TONGUE, HAIR = 0, 1, 2, 3, 4


class Samples(NamedTuple):
    """What the samples of a picture see, as ``raster.rasterize`` leaves it."""

    seen: NDArray[np.int32]
    weights: NDArray[np.float32]
    clear: NDArray[np.float32]


class Surface(NamedTuple):
    """What is seen: solids, then hair."""

    triangles: NDArray[np.int32]
    """[F, 3]"""
    parts: NDArray[np.uint8]
    """[F]"""
    uv: NDArray[np.float32]
    """[F, 3, 2] in the map of the part."""
    slopes: NDArray[np.float32]
    """[F, 2, 3] gradients of u and v along the posed surface, 1/m."""
    vertices: NDArray[np.float32]
    """[V, 3] posed."""
    normals: NDArray[np.float32]
    """[V, 3] posed."""
    folds: NDArray[np.float32]
    """[V, 1] compression."""
    eyes: NDArray[np.float32]
    """[2, 7] middle of each eyeball, where it looks, its radius."""
    strands: NDArray[np.float32]
    """[L, 3, 3] the direction of strands at the corners of the cards, which are the last triangles."""


class Light(NamedTuple):
    """What light there is; the first three as ``shadows.arriving`` gives them, spread under the skin."""

    arriving: NDArray[np.float32]
    """[V, 3]"""
    mean: NDArray[np.float32]
    """[V, 3]"""
    shares: NDArray[np.float32]
    """[V, lamps + 1]"""
    lobes: NDArray[np.float32]
    """[lamps, 7] the lamps."""
    bulbs: NDArray[np.float32]
    """[2, 4] their bright middles."""
    room: NDArray[np.float32]
    """[3] the even radiance."""


class Maps(NamedTuple):
    """Pictures of the surface, as ``Subject`` has them."""

    albedo: NDArray[np.float32]
    detail: NDArray[np.float32]
    hair: NDArray[np.float32]
    hair_color: NDArray[np.float32]
    """[2, 3] linear."""


@numba.njit(cache=True, parallel=True, fastmath=True)
def shade(samples, surface, light, maps, eye, image):
    """Linear-light premultiplied RGBA, ``image`` [H, W, 4], of the samples; ``eye`` [3] is where the camera stands."""
    height, width = samples.seen.shape
    for row in numba.prange(height):
        base = np.empty(3)
        shine = np.empty(3)
        lit = np.empty(3)
        for column in range(width):
            t = samples.seen[row, column]
            if t < 0:
                for k in range(4):
                    image[row, column, k] = 0
                continue
            spot = _spot(t, samples.weights[row, column], surface, eye)
            for k in range(3):
                lit[k] = mixed(light.arriving, spot.corners, spot.shares, k)
                shine[k] = 0.0
            if surface.parts[t] == HAIR:
                _shade_hair(spot, surface, light, maps, base, lit, shine)
            else:
                _shade_solid(spot, surface, light, maps, base, lit, shine)
            through = samples.clear[row, column]
            for k in range(3):
                image[row, column, k] = _toned((base[k] * lit[k] + shine[k]) * EXPOSURE, through)
            image[row, column, 3] = 1


@numba.njit(cache=True, inline="always")
def _spot(t, weights, surface, eye):
    """What a sample sees of triangle ``t``; ``weights`` [2] of its second and third corner."""
    corners = surface.triangles[t, 0], surface.triangles[t, 1], surface.triangles[t, 2]
    shares = 1 - weights[0] - weights[1], weights[0], weights[1]
    point = mixed_vector(surface.vertices, corners, shares)
    normal = unit(mixed_vector(surface.normals, corners, shares), 1e-9)
    to_eye = unit((eye[0] - point[0], eye[1] - point[1], eye[2] - point[2]), 1e-9)
    u, v = mixed(surface.uv[t], (0, 1, 2), shares, 0), mixed(surface.uv[t], (0, 1, 2), shares, 1)
    return Spot(t, corners, shares, u, v, point, normal, to_eye)


@numba.njit(cache=True, inline="always")
def _shade_hair(spot, surface, light, maps, base, lit, shine):
    """Fill ``base``, add to ``shine`` and weaken ``lit``, all [3], where hair is seen."""
    level = sampled(maps.hair, spot.u, spot.v, 0)
    for k in range(3):
        lighter = min(max((level - 0.45) * 1.6, 0.0), 1.0)
        base[k] = maps.hair_color[0, k] + (maps.hair_color[1, k] - maps.hair_color[0, k]) * lighter
    card = spot.triangle - (len(surface.triangles) - len(surface.strands))
    strand = unit(mixed_vector(surface.strands[card], (0, 1, 2), spot.shares), 1e-6)
    gleam(shine, light, spot, strand, base, level)
    for k in range(3):
        lit[k] *= 0.35 + 0.9 * level


@numba.njit(cache=True, inline="always")
def _shade_solid(spot, surface, light, maps, base, lit, shine):
    """Fill ``base``, add to ``shine`` and dim ``lit`` in folds, all [3], where anything else is seen."""
    part, u, v = surface.parts[spot.triangle], spot.u, spot.v
    for k in range(3):
        base[k] = sampled(maps.albedo, u, v, k)
    normal = spot.normal
    f0, sheen, rough = SKIN_F0, 0.8, (0.2, 0.2)
    if part == SKIN:
        sheen, rough = sampled(maps.detail, u, v, 0) * OILY, ROUGH
        fold = mixed(surface.folds, spot.corners, spot.shares, 0)
        normal = skin_normal(spot, surface.slopes[spot.triangle], maps.detail, fold)
        mean = unit(mixed_vector(light.mean, spot.corners, spot.shares), 1e-9)
        _dim(lit, dot(spot.normal, mean), dot(normal, mean), fold * sampled(maps.detail, u, v, 1))
    elif part == EYES:
        f0, sheen, rough = EYE_F0, 1.0, (EYE_ROUGH, EYE_ROUGH)
        normal = eye_normal(spot.point, surface.eyes[0 if u > EYES_PART_U else 1])
    elif part == TEETH:
        f0, rough = TOOTH_F0, (TOOTH_ROUGH, TOOTH_ROUGH)
    facing = max(dot(normal, spot.to_eye), 0.02)
    mirrored = reflected(spot.to_eye, normal, facing)
    fresnel = f0 + (1 - f0) * (1 - facing) ** 5 * (0.55 if part == SKIN else 1.0)
    mirror(shine, light, spot, mirrored, facing, fresnel * sheen, rough)
    if part == EYES:
        glint(shine, light, spot, mirrored)


@numba.njit(cache=True, inline="always")
def _dim(lit, smooth, bent, crease):
    """Change ``lit`` [3] by how much less a surface faces the light's mean direction than it would if it were smooth
    (both cosines), and by how deep it lies in a fold; light that is lost in a fold comes back red."""
    bent = 1 + 0.8 * (bent - smooth) / max(smooth, 0.35)
    bent = min(max(bent, 0.4), 1.5) * (1 - FOLD_DARKENS * crease)
    for k in range(3):
        lit[k] *= bent + (1 - bent) * (0.25 if k == 0 else 0.0)


@numba.njit(cache=True, inline="always")
def _toned(value, through):
    """Linear light behind lashes that let ``through`` so much, its highlights softened."""
    value = value * through + 0.012 * (1 - through)
    if value > SHOULDER:
        value = SHOULDER + (1 - SHOULDER) * np.tanh((value - SHOULDER) / SOFT)
    return value
