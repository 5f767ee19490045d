"""The two sides of a face."""

import numpy as np
import pytest
from gemheads.models.heads.sides import around_eyes, sides_of

X, Y = np.meshgrid(np.arange(-3, 4), np.arange(4))
CANVAS = 0.01 * np.stack([X.ravel(), Y.ravel(), 0 * X.ravel()], 1)
LEFT = [(c := 7 * y + x, c + 1, c + 8) for y in range(3) for x in range(3, 6)]


def reflected(corners: tuple[int, ...]) -> list[int]:
    """The same triangle right of the middle, its corners in another order."""
    return [7 * (v // 7) + 6 - v % 7 for v in corners[::-1]]


def test_a_point_is_sent_to_its_mirror_image_and_back() -> None:
    triangles = np.array([*LEFT, *(reflected(corners) for corners in LEFT)])
    sides, rng = sides_of(CANVAS, triangles), np.random.default_rng(1)
    faces, weights = rng.integers(len(triangles), size=50), rng.dirichlet(np.ones(3), 50)
    there = sides.across(faces, weights)
    here, other = ((CANVAS[triangles[f]] * w[..., None]).sum(1) for f, w in ((faces, weights), there))
    np.testing.assert_allclose(other, here * [-1, 1, 1], atol=1e-12)
    back = sides.across(*there)
    np.testing.assert_array_equal(back[0], faces)
    np.testing.assert_allclose(back[1], weights)


def test_a_triangle_without_an_opposite_is_an_error() -> None:
    sides = sides_of(CANVAS, np.array(LEFT))
    with pytest.raises(ValueError, match="1 of 1 points have no triangle"):
        sides.across(np.array([0]), np.full((1, 3), 1 / 3))


def test_skin_around_the_eyes_fades_out_before_mouth_and_ears() -> None:
    eyes = np.array([[0.031, 0.0, 0.0], [-0.031, 0.0, 0.0], [0.031, 0.012, 0.0], [-0.045, -0.005, -0.01]])
    elsewhere = np.array([[0.03, -0.065, 0.0], [0.075, -0.01, -0.09], [0.0, 0.07, 0.0], [0.031, 0.0, -0.1]])
    assert (around_eyes(eyes) > 0.99).all()
    assert (around_eyes(elsewhere) < 0.01).all()
    path = np.linspace([0.031, 0.0, 0.0], [0.031, -0.065, 0.0], 200)
    assert np.abs(np.diff(around_eyes(path))).max() < 0.03
