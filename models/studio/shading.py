"""The colour of every sample: light under and on the skin, wet eyes, hair, and what folds do to them."""

import numba
import numpy as np

from ..heads.subjectfile import EYES_PART_U
from .raster import sampled

EXPOSURE = 0.95
PORE_M = 0.10e-3
"""Height of the skin's pores, from their mean to the top."""
FOLD_M = 0.55e-3
"""Depth of the deepest line where the skin is compressed most."""
FOLD_DARKENS = 0.42
SKIN_F0, EYE_F0, TOOTH_F0 = 0.028, 0.025, 0.045
ROUGH = (0.30, 0.16)
"""The two lobes of skin, GGX's alpha; the first has two thirds."""
OILY = 3.0
HAIR_SHINE = 0.12
EYE_ROUGH, TOOTH_ROUGH = 0.03, 0.12
BULB_COS = (0.975, 0.987)
"""Edge of a bulb as a wet eye mirrors it."""
GLINT = 1.1
CORNEA_BULGE = 0.42
"""How far in front of the eyeball's centre the cornea's is, in eyeball radii."""
CORNEA_COS = 0.86
SHOULDER, SOFT = 0.70, 0.45
SKIN, EYES, TEETH, TONGUE, HAIR = 0, 1, 2, 3, 4


@numba.njit(cache=True, parallel=True, fastmath=True)
def shade(
    seen,
    weights,
    clear,
    triangles,
    parts,
    uv,
    slopes,
    vertices,
    normals,
    light,
    mean,
    shares,
    folds,
    eyes,
    lobes,
    bulbs,
    room,
    albedo,
    detail,
    hair,
    hair_color,
    hair_along,
    eye,
    image,
):
    """Linear-light premultiplied RGBA [H, W, 4] of the samples that ``raster.rasterize`` filled.

    Args:
        seen, weights, clear: as ``rasterize`` leaves them.
        triangles: [F, 3] solids, then hair; ``parts`` [F]; ``uv`` [F, 3, 2] in the map of the part.
        slopes: [F, 2, 3] gradients of u and v along the posed surface, 1/m.
        vertices, normals: [V, 3] posed.
        light, mean, shares: as ``shadows.arriving`` gives them, spread under the skin.
        folds: [V] compression.
        eyes: [2, 7] middle of each eyeball, where it looks, its radius.
        lobes, bulbs, room: the lamps [n, 7], their bright middles [2, 4], the even radiance [3].
        albedo, detail, hair: maps, as ``Subject`` has them; ``hair_color`` [2, 3] linear; ``hair_along`` [L, 3, 3] the
            direction of strands at the corners of the cards.
        eye: [3] position of the camera.
        image: [H, W, 4] the answer.
    """
    height, width = seen.shape
    lamps = len(lobes)
    texel = 1.0 / albedo.shape[0]
    for row in numba.prange(height):
        base = np.empty(3)
        shine = np.empty(3)
        lit = np.empty(3)
        for column in range(width):
            t = seen[row, column]
            if t < 0:
                for k in range(4):
                    image[row, column, k] = 0
                continue
            a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
            wb, wc = weights[row, column, 0], weights[row, column, 1]
            wa = 1 - wb - wc
            part = parts[t]
            u = uv[t, 0, 0] * wa + uv[t, 1, 0] * wb + uv[t, 2, 0] * wc
            v = uv[t, 0, 1] * wa + uv[t, 1, 1] * wb + uv[t, 2, 1] * wc
            px = vertices[a, 0] * wa + vertices[b, 0] * wb + vertices[c, 0] * wc
            py = vertices[a, 1] * wa + vertices[b, 1] * wb + vertices[c, 1] * wc
            pz = vertices[a, 2] * wa + vertices[b, 2] * wb + vertices[c, 2] * wc
            nx = normals[a, 0] * wa + normals[b, 0] * wb + normals[c, 0] * wc
            ny = normals[a, 1] * wa + normals[b, 1] * wb + normals[c, 1] * wc
            nz = normals[a, 2] * wa + normals[b, 2] * wb + normals[c, 2] * wc
            length = 1 / max(np.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
            nx, ny, nz = nx * length, ny * length, nz * length
            vx, vy, vz = eye[0] - px, eye[1] - py, eye[2] - pz
            length = 1 / max(np.sqrt(vx * vx + vy * vy + vz * vz), 1e-9)
            vx, vy, vz = vx * length, vy * length, vz * length
            for k in range(3):
                lit[k] = light[a, k] * wa + light[b, k] * wb + light[c, k] * wc
                shine[k] = 0.0
            mx = mean[a, 0] * wa + mean[b, 0] * wb + mean[c, 0] * wc
            my = mean[a, 1] * wa + mean[b, 1] * wb + mean[c, 1] * wc
            mz = mean[a, 2] * wa + mean[b, 2] * wb + mean[c, 2] * wc
            length = 1 / max(np.sqrt(mx * mx + my * my + mz * mz), 1e-9)
            mx, my, mz = mx * length, my * length, mz * length

            if part == HAIR:
                level = sampled(hair, u, v, 0)
                for k in range(3):
                    base[k] = hair_color[0, k] + (hair_color[1, k] - hair_color[0, k]) * min(
                        max((level - 0.45) * 1.6, 0.0), 1.0
                    )
                card = t - (len(triangles) - len(hair_along))
                tx = hair_along[card, 0, 0] * wa + hair_along[card, 1, 0] * wb + hair_along[card, 2, 0] * wc
                ty = hair_along[card, 0, 1] * wa + hair_along[card, 1, 1] * wb + hair_along[card, 2, 1] * wc
                tz = hair_along[card, 0, 2] * wa + hair_along[card, 1, 2] * wb + hair_along[card, 2, 2] * wc
                length = 1 / max(np.sqrt(tx * tx + ty * ty + tz * tz), 1e-6)
                tx, ty, tz = tx * length, ty * length, tz * length
                for lamp in range(lamps):
                    hx, hy, hz = vx + lobes[lamp, 0], vy + lobes[lamp, 1], vz + lobes[lamp, 2]
                    length = 1 / max(np.sqrt(hx * hx + hy * hy + hz * hz), 1e-6)
                    along = (tx * hx + ty * hy + tz * hz) * length + 0.5 * (level - 0.5)
                    share = shares[a, lamp] * wa + shares[b, lamp] * wb + shares[c, lamp] * wc
                    toward = max(nx * lobes[lamp, 0] + ny * lobes[lamp, 1] + nz * lobes[lamp, 2] + 0.2, 0.0)
                    power = HAIR_SHINE * level * level * share * toward * max(1 - along * along, 0.0) ** 20
                    for k in range(3):
                        shine[k] += power * lobes[lamp, 3 + k] * (0.2 + 8 * base[k])
                for k in range(3):
                    image[row, column, k] = (base[k] * lit[k] * (0.35 + 0.9 * level) + shine[k]) * EXPOSURE
            else:
                for k in range(3):
                    base[k] = sampled(albedo, u, v, k)
                f0, sheen, alpha, second = SKIN_F0, 0.0, ROUGH[0], ROUGH[1]
                if part == SKIN:
                    sheen = sampled(detail, u, v, 0) * OILY
                    fold = folds[a] * wa + folds[b] * wb + folds[c] * wc
                    crease = sampled(detail, u, v, 1)
                    du = (sampled(detail, u + texel, v, 2) - sampled(detail, u - texel, v, 2)) * PORE_M
                    dv = (sampled(detail, u, v + texel, 2) - sampled(detail, u, v - texel, 2)) * PORE_M
                    du -= (sampled(detail, u + texel, v, 1) - sampled(detail, u - texel, v, 1)) * FOLD_M * fold
                    dv -= (sampled(detail, u, v + texel, 1) - sampled(detail, u, v - texel, 1)) * FOLD_M * fold
                    du, dv = du / (2 * texel), dv / (2 * texel)
                    before = nx * mx + ny * my + nz * mz
                    nx -= du * slopes[t, 0, 0] + dv * slopes[t, 1, 0]
                    ny -= du * slopes[t, 0, 1] + dv * slopes[t, 1, 1]
                    nz -= du * slopes[t, 0, 2] + dv * slopes[t, 1, 2]
                    length = 1 / max(np.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
                    nx, ny, nz = nx * length, ny * length, nz * length
                    bent = 1 + 0.8 * (nx * mx + ny * my + nz * mz - before) / max(before, 0.35)
                    bent = min(max(bent, 0.4), 1.5) * (1 - FOLD_DARKENS * fold * crease)
                    for k in range(3):  # light that is lost in a fold comes back red
                        lit[k] *= bent + (1 - bent) * (0.25 if k == 0 else 0.0)
                elif part == EYES:
                    f0, sheen, alpha, second = EYE_F0, 1.0, EYE_ROUGH, EYE_ROUGH
                    side = 0 if u > EYES_PART_U else 1
                    ox, oy, oz = px - eyes[side, 0], py - eyes[side, 1], pz - eyes[side, 2]
                    length = 1 / max(np.sqrt(ox * ox + oy * oy + oz * oz), 1e-9)
                    off = (ox * eyes[side, 3] + oy * eyes[side, 4] + oz * eyes[side, 5]) * length
                    blend = min(max((off - CORNEA_COS) / 0.06, 0.0), 1.0)
                    shift = CORNEA_BULGE * eyes[side, 6] * blend
                    nx, ny, nz = ox - shift * eyes[side, 3], oy - shift * eyes[side, 4], oz - shift * eyes[side, 5]
                    length = 1 / max(np.sqrt(nx * nx + ny * ny + nz * nz), 1e-9)
                    nx, ny, nz = nx * length, ny * length, nz * length
                elif part == TEETH:
                    f0, sheen, alpha, second = TOOTH_F0, 0.8, TOOTH_ROUGH, TOOTH_ROUGH
                else:
                    f0, sheen, alpha, second = SKIN_F0, 0.8, 0.2, 0.2
                facing = max(nx * vx + ny * vy + nz * vz, 0.02)
                rx, ry, rz = 2 * facing * nx - vx, 2 * facing * ny - vy, 2 * facing * nz - vz
                fresnel = f0 + (1 - f0) * (1 - facing) ** 5 * (0.55 if part == SKIN else 1.0)
                open_room = shares[a, lamps] * wa + shares[b, lamps] * wb + shares[c, lamps] * wc
                for lobe in range(2):
                    rough = alpha if lobe == 0 else second
                    part_of = (0.67 if lobe == 0 else 0.33) * fresnel * sheen
                    # GGX as a spherical Gaussian, warped to the mirrored direction (Wang et al. 2009, eq. 21)
                    sharp = 2 / (rough * rough) / (4 * facing)
                    for lamp in range(lamps):
                        share = shares[a, lamp] * wa + shares[b, lamp] * wb + shares[c, lamp] * wc
                        cos = rx * lobes[lamp, 0] + ry * lobes[lamp, 1] + rz * lobes[lamp, 2]
                        wide = lobes[lamp, 6]
                        value = sharp / (sharp + wide) * np.exp(sharp * wide / (sharp + wide) * (cos - 1))
                        for k in range(3):
                            shine[k] += part_of * value * share * lobes[lamp, 3 + k]
                    for k in range(3):
                        shine[k] += part_of * room[k] * open_room * open_room
                if part == EYES:
                    share = shares[a, 0] * wa + shares[b, 0] * wb + shares[c, 0] * wc
                    for bulb in range(len(bulbs)):
                        cos = rx * bulbs[bulb, 0] + ry * bulbs[bulb, 1] + rz * bulbs[bulb, 2]
                        edge = min(max((cos - BULB_COS[0]) / (BULB_COS[1] - BULB_COS[0]), 0.0), 1.0)
                        for k in range(3):
                            shine[k] += GLINT * edge * bulbs[bulb, 3] * share
                for k in range(3):
                    image[row, column, k] = (base[k] * lit[k] + shine[k]) * EXPOSURE
            through = clear[row, column]
            for k in range(3):
                value = image[row, column, k] * through + 0.012 * (1 - through)
                if value > SHOULDER:
                    value = SHOULDER + (1 - SHOULDER) * np.tanh((value - SHOULDER) / SOFT)
                image[row, column, k] = value
            image[row, column, 3] = 1
