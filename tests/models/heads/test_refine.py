"""Colours are fitted where the views say something, and stay where they do not."""

import numpy as np
from gemheads.models.heads.refine import View, refined
from gemheads.render.camera import orbit
from gemheads.render.gaussians import RawGaussians

GREY, RED = np.full(3, 0.5, np.float32), np.array([0.9, 0.2, 0.2], np.float32)


def wall_and_what_it_hides() -> View:
    """A wall of one splat fills a red picture; a small splat behind it all but vanishes."""
    raw = RawGaussians(
        positions=np.array([[0, 0, 0], [0, 0, -0.1]], np.float32),
        wxyz=np.tile(np.float32([1, 0, 0, 0]), (2, 1)),
        log_scales=np.log(np.float32([[0.5, 0.5, 0.01], [0.01, 0.01, 0.01]])),
        opacity_logits=np.float32([4, 4]),
        colors=np.stack([GREY, GREY]),
    )
    target = np.tile(RED, (16, 16, 1))
    return View(raw, orbit((0.0, 0.0, 0.0), 1.0, 0, 0, 10, 16, 16), target, np.ones((16, 16), np.bool_))


def test_what_is_seen_takes_the_colour_of_the_picture() -> None:
    wall, _ = refined(np.stack([GREY, GREY]), [wall_and_what_it_hides()], np.ones(2))
    np.testing.assert_allclose(wall, RED, atol=0.03)


def test_what_is_hardly_seen_does_not_mend_what_others_miss() -> None:
    wall, hidden = refined(np.stack([GREY, GREY]), [wall_and_what_it_hides()], np.array([0.1, 1.0]))
    np.testing.assert_allclose(wall, np.clip(RED, 0.4, 0.6), atol=1e-6)
    np.testing.assert_allclose(hidden, GREY, atol=0.1)
