"""The driver's picture beside the avatar's keeps its shape."""

import numpy as np
from gemheads.app.reenacting.beside import beside_width, side_by_side


def test_a_driver_fills_the_width_that_was_made_for_it() -> None:
    width = beside_width((641, 480), 512)
    picture = side_by_side(np.zeros((480, 641, 3), np.uint8), np.full((512, 512, 3), 90, np.uint8), width)
    assert picture.shape == (512, width + 512, 3)
    assert not picture[:, :width].any()
    assert (picture[:, width:] == 90).all()


def test_a_picture_of_another_shape_is_not_squashed() -> None:
    driver = np.zeros((100, 200, 3), np.uint8)
    tall = side_by_side(driver, np.zeros((64, 64, 3), np.uint8), 64)[:, :64]
    assert (tall[:16] == 255).all()
    assert (tall[48:] == 255).all()
    assert not tall[16:48].any()


def test_a_panorama_takes_no_more_room_than_video_has() -> None:
    assert beside_width((16384, 16), 4096) + 4096 == 16384
    panorama = side_by_side(np.zeros((10, 200, 3), np.uint8), np.zeros((40, 40, 3), np.uint8), 120)[:, :120]
    assert not panorama[17:23].any()
    assert (panorama[:16] == 255).all()
