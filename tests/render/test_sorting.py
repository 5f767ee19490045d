"""Depth order against NumPy's stable sort."""

import numpy as np
from gemheads.render.sorting import front_to_back
from numpy.typing import ArrayLike, NDArray


def near_to_far(depths: ArrayLike) -> NDArray[np.int32]:
    """Indices of the splats with depth > 0, of depths [N] in metres."""
    metres = np.ascontiguousarray(depths, np.float64)
    orders = np.empty((2, len(metres)), np.int32)
    visible = front_to_back(metres, orders)
    return orders[0, :visible]


def test_a_stable_sort_with_ties() -> None:
    rng = np.random.default_rng(0)
    depths = rng.choice(np.array([0.011, 0.5, 0.50000000003, 1, 3e4]), 10_000) * rng.choice(np.array([1, 2]), 10_000)
    np.testing.assert_array_equal(near_to_far(depths), np.argsort(depths, kind="stable"))


def test_full_precision() -> None:
    depths = np.random.default_rng(1).uniform(0.4, 0.6, 50_000)
    np.testing.assert_array_equal(near_to_far(depths), np.argsort(depths, kind="stable"))


def test_depth_zero_is_left_out() -> None:
    np.testing.assert_array_equal(near_to_far(np.float32([0, 2, 0, 1])), [3, 1])
    assert len(near_to_far(np.float32([]))) == 0
