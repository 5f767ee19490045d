"""What tile rasterisers share: which splats touch which tile, the turn in which tiles are drawn, the exponential."""

import numba
import numpy as np

from .projection import TRANSMITTANCE_MIN

TILE = 16
"""Side of a tile in pixels; tiles of 8 take 2.5 to 4 times as long."""
LOG256_E = 1 / np.log(256)
"""Exponents are kept in powers of 256: that is what ``power_of_256`` takes, and 1/256 < ALPHA_MIN is skipped anyway."""
_STRIDE = 7919
_MARGIN = np.float32(0.01)
"""Pixels that rounding may take off the edge of a splat."""
_LINE = 16
"""Float32 numbers in a cache line, and in the widest vector."""
_F = np.float32


@numba.njit(cache=True)
def count_pairs(depths, spans, columns, rows, ends):
    """Write into ``ends`` int64 [tiles + 1] where the pairs of each tile begin, after those of the tile before; the
    last is how many there are.

    ``spans`` int32 [N, 4]: first and last column, first and last row of tiles of each splat; a splat of depth 0 has
    none.
    """
    # how many more there are than in the tile to the left and the one above (Crow 1984): four numbers a splat
    more = np.zeros((rows + 1, columns + 1), np.int64)
    for i in range(len(depths)):
        if depths[i] > 0:
            left, right, top, bottom = spans[i]
            more[top, left] += 1
            more[top, right + 1] -= 1
            more[bottom + 1, left] -= 1
            more[bottom + 1, right + 1] += 1
    above = np.zeros(columns, np.int64)
    ends[0] = 0
    for row in range(rows):
        here = 0
        for column in range(columns):
            here += more[row, column]
            above[column] += here
            tile = row * columns + column
            ends[tile + 1] = ends[tile] + above[column]


@numba.njit(cache=True)
def fill_pairs(order, visible, spans, columns, ends, first, last, pairs):
    """Write the splats of each tile from ``first`` to before ``last``, in the order of ``order``, into ``pairs``: from
    ends[tile] to ends[tile + 1], less ends[first]."""
    place = ends[first:last] - ends[first]
    highest, lowest = first // columns, (last - 1) // columns
    for j in range(visible):
        left, right, top, bottom = spans[order[j]]
        for row in range(max(top, highest), min(bottom, lowest) + 1):
            begin = row * columns
            for tile in range(max(begin + left, first), min(begin + right + 1, last)):
                pairs[place[tile - first]] = order[j]
                place[tile - first] += 1


@numba.njit(cache=True)
def run_of_tiles(ends, first, most):
    """The tile before which a run that begins with tile ``first`` ends: it has at most ``most`` pairs, or one tile."""
    last = first + 1
    while last + 1 < len(ends) and ends[last + 1] - ends[first] <= most:
        last += 1
    return last


@numba.njit(cache=True, inline="always")
def aligned(rows, columns):
    """Room for float32 [rows, columns] that begins where a cache line does. What ``np.empty`` gives begins in the midst
    of one as often as not, and then every vector of 512 bits lies in two."""
    room = np.empty(rows * columns + _LINE, np.float32)
    skip = (-room.ctypes.data // 4) % _LINE
    return room[skip : skip + rows * columns].reshape(rows, columns)


@numba.njit(cache=True, inline="always")
def tile_of(turn, tiles):
    """The tile drawn in this turn. Threads take runs of turns: strides of a prime spread the busy middle of the picture
    over all of them."""
    return (np.int64(turn) * _STRIDE) % tiles if tiles % _STRIDE else np.int64(turn)


@numba.njit(cache=True, inline="always")
def reached_rows(dx0, dy0, reach):
    """First and last row of a tile that a splat reaches within the tile's columns; first > last where it misses them.

    At a distance d beside its centre, the ellipse at ALPHA_MIN spans d * slope +- height * sqrt(1 - (d / half)^2).
    Its lowest point is at d = lowest; a tile without that column reaches lowest in the nearest column it has.

    Args:
        dx0: from the splat's centre to the centre of the tile's first pixel, to the right ...
        dy0: ... and down.
        reach: [4] half the width, slope, height, lowest of ``reach_of``; pixels.
    """
    half, slope, height, lowest = reach[0], reach[1], reach[2], reach[3]
    right = dx0 + _F(TILE - 1)
    if dx0 > half + _MARGIN or right < -half - _MARGIN:
        return TILE, -1
    low, high = min(max(lowest, dx0), right), min(max(-lowest, dx0), right)
    share_low, share_high = low / half, high / half
    bottom = low * slope + height * np.sqrt(max(_F(0), _F(1) - share_low * share_low))
    top = high * slope - height * np.sqrt(max(_F(0), _F(1) - share_high * share_high))
    # compared as floats first: a splat may lie further away than an integer can say
    first, last = np.ceil(top - dy0 - _MARGIN), np.floor(bottom - dy0 + _MARGIN)
    return int(min(max(first, _F(0)), _F(TILE))), int(max(min(last, _F(TILE - 1)), _F(-1)))


@numba.njit(cache=True, inline="always")
def write_reach(sigmas, a, b, c, determinant, reach):
    """Write what ``reached_rows`` needs into ``reach`` [4].

    Args:
        sigmas: how far the splat reaches, in standard deviations.
        a, b, c: its covariance in pixels [[a, b], [b, c]] ...
        determinant: ... and that one's determinant.
    """
    reach[0], reach[1] = sigmas * np.sqrt(a), b / a
    reach[2], reach[3] = sigmas * np.sqrt(determinant / a), sigmas * b / np.sqrt(c)


@numba.njit(cache=True, inline="always")
def lit_rows(state, first, last):
    """First and last row from ``first`` to ``last`` of a tile through which light still gets; first > last: none.

    ``state`` float32 [TILE, TILE or more]: the light that is left comes first.
    """
    low, high = TILE, -1
    for y in range(first, last + 1):
        brightest = _F(0)
        for x in range(TILE):
            brightest = max(brightest, state[y, x])
        if brightest >= TRANSMITTANCE_MIN:
            low, high = min(low, y), y
    return low, high


@numba.njit(cache=True, inline="always")
def power_of_256(power):
    """256^power for power <= 0, not less than 1/256. Minimax of degree 5 for the eighth root, 2^power, then to its 8th:
    relative error 7e-7, no table, so that a row of pixels is one run of vector instructions."""
    t = max(power, _F(-1))
    root = _F(1) + t * (
        _F(0.69314372) + t * (_F(0.24018014) + t * (_F(0.05529736) + t * (_F(0.0092058) + t * _F(0.0009449))))
    )
    root *= root
    root *= root
    return root * root
