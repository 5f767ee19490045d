"""Blending of sorted splats, tile by tile, and its gradient. Every tile writes its own rows: no atomics, no chance."""

import numba
import numpy as np

from ..projection import ALPHA_MAX, ALPHA_MIN, TRANSMITTANCE_MIN
from ..tiles import TILE, aligned, lit_rows, power_of_two, reached_rows, tile_of

_F = np.float32
_FAST = {"contract", "reassoc", "arcp", "nsz"}
_RUN = 16
"""So many splats are drawn before a tile asks again through which of its rows light still gets."""


@numba.njit(cache=True, parallel=True, fastmath=_FAST, error_model="numpy")
def blend(pairs, ends, centers, shapes, colors, columns, rows, image, bands, lights):
    """Write the picture [H, W, 4], premultiplied RGBA, and what ``blend_back`` needs: of every pair the first row that
    it may have changed and the one after the last (``bands`` uint8 [P, 2], equal where there is none), and for every
    pixel of every tile the light that is left and the place of the last pair that took some (``lights`` float32
    [tiles, TILE, 2 TILE])."""
    height, width = image.shape[:2]
    tiles = columns * rows
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
                        alpha = min(opacity * power_of_two(e0 + dx * (e1 + a * dx)), ALPHA_MAX)
                        drawn = (alpha >= ALPHA_MIN) & (light >= TRANSMITTANCE_MIN)
                        weight = alpha * light if drawn else _F(0)
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
                image[y0 + y, x0 + x, 0] = state[y, 2 * TILE + x]
                image[y0 + y, x0 + x, 1] = state[y, 3 * TILE + x]
                image[y0 + y, x0 + x, 2] = state[y, 4 * TILE + x]
                image[y0 + y, x0 + x, 3] = _F(1) - state[y, x]


@numba.njit(cache=True, parallel=True, fastmath=_FAST, error_model="numpy")
def blend_back(pairs, ends, centers, shapes, colors, spans, firsts, columns, rows, bands, lights, d_image, sums):
    """Write into ``sums`` [P, SUMS] (see ``projecting.SUMS``) what every pair adds to its splat's gradients.

    Back to front: the light in front of a splat is that behind it over 1 - alpha. What lies behind is carried along as
    one number a pixel: its colour under full light times the picture's gradient; transparent ground counts as colour in
    alpha.
    """
    height, width = d_image.shape[:2]
    tiles = columns * rows
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
                inside = x0 + x < width and y0 + y < height
                state[0, j] = lights[tile, y, x]
                state[1, j] = -d_image[y0 + y, x0 + x, 3] if inside else _F(0)
                state[2, j] = lights[tile, y, TILE + x] if inside else _F(-1)
                for k in range(3):
                    state[3 + k, j] = d_image[y0 + y, x0 + x, k] if inside else _F(0)
                state[6, j], state[7, j] = _F(x), _F(y)
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
                shape = power_of_two(dx * (a * dx + b * dy) + c * dy * dy)
                peak = opacity * shape
                drawn = (peak >= ALPHA_MIN) & (place <= state[2, j])
                alpha = min(peak, ALPHA_MAX) if drawn else _F(0)
                light = state[0, j] / (_F(1) - alpha)
                v0, v1, v2 = state[3, j], state[4, j], state[5, j]
                behind = state[1, j]
                more = r * v0 + g * v1 + bl * v2 - behind
                q = shape * light * more if drawn & (peak <= ALPHA_MAX) else _F(0)
                state[0, j] = light
                state[1, j] = behind + alpha * more
                weight = alpha * light
                d_r += weight * v0
                d_g += weight * v1
                d_b += weight * v2
                qx, qy = q * dx, q * dy
                q00 += q
                q10 += qx
                q01 += qy
                q20 += qx * dx
                q11 += qx * dy
                q02 += qy * dy
            sums[slot, 0], sums[slot, 1], sums[slot, 2] = q00, q10, q01
            sums[slot, 3], sums[slot, 4], sums[slot, 5] = q20, q11, q02
            sums[slot, 6], sums[slot, 7], sums[slot, 8] = d_r, d_g, d_b
