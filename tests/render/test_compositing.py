"""Pictures as bytes."""

import numpy as np
from gemheads.render.compositing import over, to_rgba8

IMAGE = np.float32([[[0.5, 0.25, 0, 0.5], [0, 0, 0, 0], [1.2, 0, 0, 1]]])


def test_over_a_background() -> None:
    np.testing.assert_array_equal(over(IMAGE, (1, 0, 1)), [[[255, 64, 128], [255, 0, 255], [255, 0, 0]]])


def test_over_writes_where_it_is_told() -> None:
    out = np.zeros((1, 3, 3), np.uint8)
    assert over(IMAGE, (0, 0, 0), out) is out
    assert out[0, 0, 0] == 128


def test_straight_alpha() -> None:
    np.testing.assert_array_equal(to_rgba8(IMAGE), [[[255, 128, 0, 128], [0, 0, 0, 0], [255, 0, 0, 255]]])
