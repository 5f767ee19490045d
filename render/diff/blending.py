"""Blending of sorted splats, tile by tile, and its gradient. Every tile writes its own rows: no atomics, no chance."""

import numba
import numpy as np

from ..projection import ALPHA_MAX, ALPHA_MIN, TRANSMITTANCE_MIN
from ..tiles import TILE, aligned, lit_rows, power_of_256, reached_rows, tile_of

_F = np.float32
_FAST = {"contract", "reassoc", "arcp", "nsz"}
_RUN = 16
"""So many splats are drawn before a tile asks again through which of its rows light still gets."""


@numba.njit(cache=True, parallel=True, fastmath=_FAST, error_model="numpy")
def blend(pairs, ends, centers, shapes, colors, ground, columns, rows, image, bands, lights):
    """Write the picture, and what ``blend_back`` needs.

    Args:
        ground: float32 RGB behind the splats, [H W, 3] or [1, 3] for all pixels.
        image: [H, W, 3] RGB, or [H, W, 4] with alpha: premultiplied if the ground is black.
        bands: uint8 [P, 2], the first row of the tile that each pair may have changed, and the one after the last;
            equal where there is none.
        lights: float32 [tiles, TILE, 2 TILE], the light that is left in every pixel, and the place of the last pair
            that took some.
    """
    height, width = image.shape[:2]
    tiles, own = columns * rows, int(len(ground) > 1)
    for turn in numba.prange(tiles):
        tile = tile_of(turn, tiles)
        x0, y0 = (tile % columns) * TILE, (tile // columns) * TILE
        # light, place, red, green, blue side by side: one array, so that the compiler sees that they do not overlap
        state = aligned(TILE, 5 * TILE)
        for y in range(TILE):
            for x in range(5 * TILE):
                state[y, x] = 0
            for x in range(TILE):
                state[y, x], state[y, TILE + x] = 1, -1
        start = ends[tile]
        first, last = 0, TILE - 1
        for begin in range(start, ends[tile + 1], _RUN):
            first, last = lit_rows(state, first, last)
            if first > last:
                bands[begin : ends[tile + 1]] = 0
                break
            count = min(_RUN, ends[tile + 1] - begin)
            # for a run at once: the rows of the next splat are known before they are needed
            for k in range(count):
                i = pairs[begin + k]
                cx, cy = _F(centers[i, 0] - x0 - 0.5), _F(centers[i, 1] - y0 - 0.5)
                top, bottom = reached_rows(-cx, -cy, shapes[i, 4:])
                top, bottom = max(top, first), min(bottom, last)
                bands[begin + k, 0], bands[begin + k, 1] = top, max(top, bottom + 1)
            for k in range(count):
                i = pairs[begin + k]
                place = _F(begin + k - start)
                cx, cy = _F(centers[i, 0] - x0 - 0.5), _F(centers[i, 1] - y0 - 0.5)
                a, b, c, opacity = shapes[i, 0], shapes[i, 1], shapes[i, 2], shapes[i, 3]
                r, g, bl = colors[i, 0], colors[i, 1], colors[i, 2]
                for y in range(np.int64(bands[begin + k, 0]), np.int64(bands[begin + k, 1])):
                    dy = _F(y) - cy
                    e0, e1 = c * dy * dy, b * dy
                    for x in range(TILE):
                        dx = _F(x) - cx
                        light = state[y, x]
                        peak = opacity * power_of_256(e0 + dx * (e1 + a * dx))
                        drawn = (peak >= ALPHA_MIN) & (light >= TRANSMITTANCE_MIN)
                        weight = (min(peak, ALPHA_MAX) if drawn else _F(0)) * light
                        state[y, x] = light - weight
                        state[y, TILE + x] = place if drawn else state[y, TILE + x]
                        state[y, 2 * TILE + x] += weight * r
                        state[y, 3 * TILE + x] += weight * g
                        state[y, 4 * TILE + x] += weight * bl
        for y in range(TILE):
            for x in range(2 * TILE):
                lights[tile, y, x] = state[y, x]
        for y in range(min(TILE, height - y0)):
            for x in range(min(TILE, width - x0)):
                under = ground[((y0 + y) * width + x0 + x) * own]
                for k in range(3):
                    image[y0 + y, x0 + x, k] = state[y, (2 + k) * TILE + x] + state[y, x] * under[k]
                if image.shape[2] == 4:
                    image[y0 + y, x0 + x, 3] = _F(1) - state[y, x]


@numba.njit(cache=True, parallel=True, fastmath=_FAST, error_model="numpy")
def blend_back(
    pairs, ends, centers, shapes, colors, ground, spans, firsts, columns, rows, bands, lights, d_image, d_ground, sums
):
    """Write into ``sums`` [P, SUMS] (see ``projecting.SUMS``) what every pair adds to its splat's gradients, and into
    ``d_ground`` the ground's: [H W, 3] where every pixel has its own, else what every tile adds to it, [tiles, 3].

    Back to front: the light in front of a splat is that behind it over 1 - alpha. What lies behind is carried along as
    one number a pixel: its colour under full light times the picture's gradient. Transparent ground counts as colour in
    alpha.
    """
    height, width = d_image.shape[:2]
    tiles, own = columns * rows, int(len(ground) > 1)
    for turn in numba.prange(tiles):
        tile = tile_of(turn, tiles)
        column, row = tile % columns, tile // columns
        x0, y0 = column * TILE, row * TILE
        # light, behind, place, gradient of red, green, blue, x, y, each of all pixels: a splat's rows are then one run,
        # and its sums stay in vectors until the end of it
        state = aligned(8, TILE * TILE)
        for y in range(TILE):
            for x in range(TILE):
                j = y * TILE + x
                state[0, j], state[1, j], state[2, j], state[3, j], state[4, j], state[5, j] = 0, 0, -1, 0, 0, 0
                state[6, j], state[7, j] = x, y
        red, green, blue = 0.0, 0.0, 0.0
        for y in range(min(TILE, height - y0)):
            for x in range(min(TILE, width - x0)):
                j, pixel, given = y * TILE + x, (y0 + y) * width + x0 + x, d_image[y0 + y, x0 + x]
                under, light = ground[pixel * own], lights[tile, y, x]
                state[0, j], state[2, j] = light, lights[tile, y, TILE + x]
                state[1, j] = given[0] * under[0] + given[1] * under[1] + given[2] * under[2]
                if len(given) == 4:
                    state[1, j] -= given[3]
                state[3, j], state[4, j], state[5, j] = given[0], given[1], given[2]
                if own:
                    for k in range(3):
                        d_ground[pixel, k] = light * given[k]
                red, green, blue = red + light * given[0], green + light * given[1], blue + light * given[2]
        if not own:
            d_ground[tile, 0], d_ground[tile, 1], d_ground[tile, 2] = red, green, blue
        start = ends[tile]
        for p in range(ends[tile + 1] - 1, start - 1, -1):
            i = pairs[p]
            slot = firsts[i] + (row - spans[i, 2]) * (spans[i, 1] - spans[i, 0] + 1) + column - spans[i, 0]
            q00, q10, q01, q20, q11, q02 = _F(0), _F(0), _F(0), _F(0), _F(0), _F(0)
            d_r, d_g, d_b = _F(0), _F(0), _F(0)
            place = _F(p - start)
            cx, cy = _F(centers[i, 0] - x0 - 0.5), _F(centers[i, 1] - y0 - 0.5)
            a, b, c, opacity = shapes[i, 0], shapes[i, 1], shapes[i, 2], shapes[i, 3]
            r, g, bl = colors[i, 0], colors[i, 1], colors[i, 2]
            # unsigned: an index that might count from the end would keep the compiler from taking pixels together
            for j in range(np.uintp(bands[p, 0]) * np.uintp(TILE), np.uintp(bands[p, 1]) * np.uintp(TILE)):
                dx, dy = state[6, j] - cx, state[7, j] - cy
                xx, xy, yy = dx * dx, dx * dy, dy * dy
                peak = opacity * power_of_256(a * xx + b * xy + c * yy)
                drawn = (peak >= ALPHA_MIN) & (place <= state[2, j])
                alpha = min(peak, ALPHA_MAX) if drawn else _F(0)
                light = state[0, j] / (_F(1) - alpha)
                v0, v1, v2 = state[3, j], state[4, j], state[5, j]
                behind = state[1, j]
                more = r * v0 - behind + g * v1 + bl * v2
                weight = alpha * light
                q = weight * more if peak <= ALPHA_MAX else _F(0)
                state[0, j] = light
                state[1, j] = behind + alpha * more
                d_r += weight * v0
                d_g += weight * v1
                d_b += weight * v2
                q00 += q
                q10 += q * dx
                q01 += q * dy
                q20 += q * xx
                q11 += q * xy
                q02 += q * yy
            sums[slot, 0], sums[slot, 1], sums[slot, 2] = q00, q10, q01
            sums[slot, 3], sums[slot, 4], sums[slot, 5] = q20, q11, q02
            sums[slot, 6], sums[slot, 7], sums[slot, 8] = d_r, d_g, d_b
