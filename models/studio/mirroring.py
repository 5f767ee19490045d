"""What surfaces mirror: lamps and room on skin, eyes and teeth, the bulbs in a wet eye, lamps along strands of hair."""

import numba
import numpy as np

from .mixing import dot, mixed, unit

HAIR_SHINE = 0.12
BULB_COS = (0.975, 0.987)
"""Edge of a bulb as a wet eye mirrors it."""
GLINT = 1.1


@numba.njit(cache=True, inline="always")
def reflected(to_eye, normal, facing):
    """The direction that is seen in a surface; ``facing``: cosine of the angle between its normal and the eye."""
    return 2 * facing * normal[0] - to_eye[0], 2 * facing * normal[1] - to_eye[1], 2 * facing * normal[2] - to_eye[2]


@numba.njit(cache=True, inline="always")
def mirror(shine, light, spot, mirrored, facing, strength, rough):
    """Add what a surface mirrors of lamps and room.

    Args:
        shine: [3] gets it.
        light: the lamps, and how much each corner sees of them; ``spot`` is the place.
        mirrored: the direction that is seen in the surface.
        facing: cosine of the angle between its normal and the eye.
        strength: how much of what arrives it mirrors.
        rough: its two lobes, GGX's alpha; the first has two thirds.
    """
    lamps = len(light.lobes)
    open_room = mixed(light.shares, spot.corners, spot.shares, lamps)
    for lobe in range(2):
        alpha = rough[0] if lobe == 0 else rough[1]
        part_of = (0.67 if lobe == 0 else 0.33) * strength
        # GGX as a spherical Gaussian, warped to the mirrored direction (Wang et al. 2009, eq. 21)
        sharp = 2 / (alpha * alpha) / (4 * facing)
        for lamp in range(lamps):
            share = mixed(light.shares, spot.corners, spot.shares, lamp)
            cos = dot(mirrored, light.lobes[lamp])
            wide = light.lobes[lamp, 6]
            value = sharp / (sharp + wide) * np.exp(sharp * wide / (sharp + wide) * (cos - 1))
            for k in range(3):
                shine[k] += part_of * value * share * light.lobes[lamp, 3 + k]
        for k in range(3):
            shine[k] += part_of * light.room[k] * open_room * open_room


@numba.njit(cache=True, inline="always")
def glint(shine, light, spot, mirrored):
    """Add the bulbs that a wet eye mirrors, as far as the first lamp is seen."""
    share = mixed(light.shares, spot.corners, spot.shares, 0)
    for bulb in range(len(light.bulbs)):
        cos = dot(mirrored, light.bulbs[bulb])
        edge = min(max((cos - BULB_COS[0]) / (BULB_COS[1] - BULB_COS[0]), 0.0), 1.0)
        for k in range(3):
            shine[k] += GLINT * edge * light.bulbs[bulb, 3] * share


@numba.njit(cache=True, inline="always")
def gleam(shine, light, spot, strand, base, level):
    """Add what hair mirrors along a ``strand``; ``base`` [3] is its colour, ``level`` how light it is here."""
    for lamp in range(len(light.lobes)):
        lobe = light.lobes[lamp]
        half = unit((spot.to_eye[0] + lobe[0], spot.to_eye[1] + lobe[1], spot.to_eye[2] + lobe[2]), 1e-6)
        along = dot(strand, half) + 0.5 * (level - 0.5)
        share = mixed(light.shares, spot.corners, spot.shares, lamp)
        toward = max(dot(spot.normal, lobe) + 0.2, 0.0)
        power = HAIR_SHINE * level * level * share * toward * max(1 - along * along, 0.0) ** 20
        for k in range(3):
            shine[k] += power * lobe[3 + k] * (0.2 + 8 * base[k])
