"""What tile rasterisers share: which splats touch which tile, the turn in which tiles are drawn, the exponential."""

import numba
import numpy as np

TILE = 16
"""Side of a tile in pixels; tiles of 8 take 2.5 to 4 times as long."""
POWER_LEAST = np.float32(-8)
"""2^-8 < ALPHA_MIN: whatever is weaker is skipped anyway."""
_STRIDE = 7919
_F = np.float32


@numba.njit(cache=True)
def count_pairs(order, visible, spans, columns, ends):
    """Add to ``ends`` [tiles + 1], one place late, how many of ``order``'s first ``visible`` splats touch each tile.

    ``spans`` int32 [N, 4]: first and last column, first and last row of tiles of each splat. The running sum of
    ``ends`` then says where each tile's pairs begin.
    """
    for j in range(visible):
        left, right, top, bottom = spans[order[j]]
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                ends[row * columns + column + 1] += 1


@numba.njit(cache=True)
def fill_pairs(order, visible, spans, columns, ends, pairs):
    """Write each tile's splats, in the order of ``order``, into ``pairs`` from ends[tile] to ends[tile + 1]."""
    place = ends[:-1].copy()
    for j in range(visible):
        left, right, top, bottom = spans[order[j]]
        for row in range(top, bottom + 1):
            for column in range(left, right + 1):
                tile = row * columns + column
                pairs[place[tile]] = order[j]
                place[tile] += 1


@numba.njit(cache=True, inline="always")
def tile_of(turn, tiles):
    """The tile drawn in this turn. Threads take runs of turns: strides of a prime spread the busy middle of the picture
    over all of them."""
    return (np.int64(turn) * _STRIDE) % tiles if tiles % _STRIDE else np.int64(turn)


@numba.njit(cache=True, inline="always")
def power_of_two(power):
    """2^power for power <= 0, not less than 2^-8. Minimax of degree 5 for the eighth root, then to its 8th: relative
    error 7e-7, no table, so that a row of pixels is one run of vector instructions."""
    t = max(power, POWER_LEAST) * _F(0.125)
    root = _F(1) + t * (
        _F(0.69314372) + t * (_F(0.24018014) + t * (_F(0.05529736) + t * (_F(0.0092058) + t * _F(0.0009449))))
    )
    root *= root
    root *= root
    return root * root
