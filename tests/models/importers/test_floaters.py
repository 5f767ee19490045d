"""Counting neighbours, against all distances of cells."""

import numpy as np
from gemheads.models.importers.floaters import CELL, neighbours


def test_neighbours_are_those_in_adjacent_cells() -> None:
    positions = np.random.default_rng(1).uniform(-0.06, 0.06, (400, 3))
    cells = np.floor(positions / CELL)
    near = (np.abs(cells[:, None] - cells[None]) <= 1).all(-1).sum(1)
    np.testing.assert_array_equal(neighbours(positions), near)
    assert near.min() >= 1


def test_a_far_splat_takes_no_memory() -> None:
    np.testing.assert_array_equal(neighbours(np.array([[0, 0, 0], [0.001, 0, 0], [999, -999, 999]])), [2, 2, 1])
