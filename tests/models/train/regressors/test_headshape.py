"""Other heads out of one avatar are symmetric, smooth and not monsters."""

import numpy as np
import pytest
from gemheads.models.gem import Viewing
from gemheads.models.train.regressors.headshape import random_shape

VIEWING = Viewing((0.0, 1.6, 0.02), 0.25)


@pytest.fixture
def face() -> np.ndarray:
    """[N, 3] an egg, its left half and the mirror image, metres."""
    rng = np.random.default_rng(0)
    half = rng.normal(size=(400, 3))
    half *= np.array([0.08, 0.12, 0.1]) / np.linalg.norm(half, axis=1, keepdims=True)
    half[:, 0] = np.abs(half[:, 0])
    return (np.concatenate([half, half * [-1, 1, 1]]) + np.asarray(VIEWING.target)).astype("f4")


def test_both_sides_of_a_head_are_alike(face: np.ndarray) -> None:
    moved = random_shape(np.random.default_rng(1)).displacement(face, VIEWING)
    np.testing.assert_allclose(moved[:400] * [-1, 1, 1], moved[400:], atol=1e-6)


def test_heads_differ_by_centimetres_and_smoothly(face: np.ndarray) -> None:
    rng = np.random.default_rng(0)
    moved = np.stack([random_shape(rng).displacement(face, VIEWING) for _ in range(60)])
    lengths = np.linalg.norm(moved, axis=2)
    assert 0.003 < np.median(lengths) < 0.015
    assert lengths.max() < 0.08
    assert np.linalg.norm(moved.mean(0), axis=1).max() < 0.01  # the avatar is the mean


def test_near_splats_stay_near(face: np.ndarray) -> None:
    """A fold would turn skin inside out."""
    step = np.array([[1e-3, 1e-3, 1e-3]], "f4")
    for seed in range(30):
        shape = random_shape(np.random.default_rng(seed))
        stretched = shape.displacement(face + step, VIEWING) - shape.displacement(face, VIEWING)
        assert np.linalg.norm(stretched, axis=1).max() < np.linalg.norm(step)


def test_a_shape_does_not_depend_on_the_size_of_the_avatar(face: np.ndarray) -> None:
    shape = random_shape(np.random.default_rng(4))
    target = np.asarray(VIEWING.target)
    twice = ((face - target) * 2 + target).astype("f4")
    larger = shape.displacement(twice, Viewing(VIEWING.target, 2 * VIEWING.head_height))
    np.testing.assert_allclose(larger, 2 * shape.displacement(face, VIEWING), atol=1e-5)
