"""Depth order against NumPy's stable sort."""

import numpy as np
from gemheads.render.sorting import back_to_front


def test_reverse_of_a_stable_sort_with_ties() -> None:
    rng = np.random.default_rng(0)
    depths = rng.choice(np.array([0.011, 0.5, 0.50000000003, 1, 3e4]), 10_000) * rng.choice(np.array([1, 2]), 10_000)
    np.testing.assert_array_equal(back_to_front(depths), np.argsort(depths, kind="stable")[::-1])


def test_full_precision() -> None:
    depths = np.random.default_rng(1).uniform(0.4, 0.6, 50_000)
    np.testing.assert_array_equal(back_to_front(depths), np.argsort(depths, kind="stable")[::-1])


def test_depth_zero_is_left_out() -> None:
    np.testing.assert_array_equal(back_to_front(np.float32([0, 2, 0, 1])), [1, 3])
    assert len(back_to_front(np.float32([]))) == 0
