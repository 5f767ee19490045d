"""Which rows of a tile a splat reaches, and through which light still gets."""

import numpy as np
import pytest
from gemheads.render.projection import ALPHA_MIN, TRANSMITTANCE_MIN
from gemheads.render.tiles import TILE, count_pairs, fill_pairs, lit_rows, reached_rows, run_of_tiles, write_reach

OPACITY = 0.9
REACH = np.float32(np.sqrt(2 * np.log(OPACITY / ALPHA_MIN)))


def splat(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A covariance [2, 2] in pixels, from round to a hundred times longer than wide, and its reach [4]."""
    angle, sizes = rng.uniform(0, np.pi), np.exp(rng.uniform(np.log(0.3), np.log(30), 2))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    covariance = turn @ np.diag(sizes**2) @ turn.T + 0.3 * np.eye(2)
    reach = np.empty(4, np.float32)
    a, b, c = (np.float32(x) for x in (covariance[0, 0], covariance[0, 1], covariance[1, 1]))
    write_reach(REACH, a, b, c, np.float32(np.linalg.det(covariance)), reach)
    return covariance, reach


def test_every_row_with_something_to_see_is_reached_and_hardly_another() -> None:
    rng = np.random.default_rng(0)
    spare = 0
    for _ in range(3000):
        covariance, reach = splat(rng)
        offset = rng.uniform(-60, 60, 2)  # from the splat's centre to the tile's first pixel
        x, y = np.meshgrid(offset[0] + np.arange(TILE), offset[1] + np.arange(TILE))
        away = np.stack([x, y], -1)
        power = -0.5 * np.einsum("yxi,ij,yxj->yx", away, np.linalg.inv(covariance), away)
        rows = np.flatnonzero((OPACITY * np.exp(power) >= ALPHA_MIN * 1.001).any(1))
        first, last = reached_rows(np.float32(offset[0]), np.float32(offset[1]), reach)
        assert rows.size == 0 or (first <= rows[0] and last >= rows[-1])
        spare += max(0, last - first + 1) - rows.size
    assert spare / 3000 < 0.5, "rows between two pixel centres are all that may be reached in vain"


@pytest.mark.parametrize("far", [1e9, 1e20, 3e38])
def test_a_splat_far_away_reaches_no_row(far: float) -> None:
    reach = np.array([5, 0, 5, 0], np.float32)
    for dx, dy in ((far, 0), (-far, 0), (0, far), (0, -far)):
        first, last = reached_rows(np.float32(dx), np.float32(dy), reach)
        assert first > last


def test_rows_without_light_are_left_out_at_both_ends() -> None:
    state = np.zeros((TILE, 4 * TILE), np.float32)
    state[:, TILE:] = 1  # colours do not count
    assert lit_rows(state, 0, TILE - 1) == (TILE, -1)
    state[3, 5] = state[7, 0] = TRANSMITTANCE_MIN
    assert lit_rows(state, 0, TILE - 1) == (3, 7)
    assert lit_rows(state, 4, TILE - 1) == (7, 7)


@pytest.mark.parametrize("most", [1, 400, 10**6])
def test_every_tile_gets_the_splats_that_touch_it_in_their_order(most: int) -> None:
    rng = np.random.default_rng(1)
    columns, rows, count = 7, 5, 200
    spans = np.sort(rng.integers(0, (columns, columns, rows, rows), (count, 4), dtype=np.int32).reshape(-1, 2, 2))
    depths = np.where(rng.random(count) < 0.2, 0, rng.uniform(1, 2, count))
    order = rng.permutation(np.flatnonzero(depths)).astype(np.int32)
    ends = np.empty(columns * rows + 1, np.int64)
    count_pairs(depths, spans.reshape(-1, 4), columns, rows, ends)
    first = 0
    while first < columns * rows:
        last = run_of_tiles(ends, first, most)
        assert first < last <= columns * rows
        pairs = np.empty(ends[last] - ends[first], np.int32)
        assert len(pairs) <= most or last == first + 1
        fill_pairs(order, len(order), spans.reshape(-1, 4), columns, ends, first, last, pairs)
        for tile in range(first, last):
            row, column = divmod(tile, columns)
            (left, right), (top, bottom) = spans[order, 0].T, spans[order, 1].T
            touching = order[(left <= column) & (column <= right) & (top <= row) & (row <= bottom)]
            np.testing.assert_array_equal(pairs[ends[tile] - ends[first] : ends[tile + 1] - ends[first]], touching)
        first = last
