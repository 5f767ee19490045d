"""Blue noise on surfaces."""

import numpy as np
from gemheads.models.heads.sampling import scatter
from scipy.spatial import cKDTree

SQUARES = np.array(
    [
        [[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]],
        [[1, 0, 0], [2, 0, 0], [2, 1, 0]], [[1, 0, 0], [2, 1, 0], [1, 1, 0]],
    ], float,
)  # fmt: skip


def test_points_keep_their_distance_and_their_number() -> None:
    face, weights, radius = scatter(SQUARES, np.ones(4), 2000, np.random.default_rng(3))
    points = (SQUARES[face] * weights[..., None]).sum(1)
    assert 0.96 * 2000 <= len(points) <= 2000
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    assert nearest.min() >= radius.min() * 0.999
    assert nearest.std() / nearest.mean() < 0.15  # random points: 0.52
    np.testing.assert_allclose(weights.sum(1), 1)


def test_density_decides_where_points_go() -> None:
    face, _, _ = scatter(SQUARES, np.array([4.0, 4, 1, 1]), 2000, np.random.default_rng(4))
    share = np.isin(face, (0, 1)).mean()
    assert 0.75 < share < 0.84
    empty, _, _ = scatter(SQUARES, np.array([0.0, 0, 1, 1]), 500, np.random.default_rng(4))
    assert not np.isin(empty, (0, 1)).any()


def test_the_same_seed_gives_the_same_points() -> None:
    one = scatter(SQUARES, np.ones(4), 300, np.random.default_rng(5))
    two = scatter(SQUARES, np.ones(4), 300, np.random.default_rng(5))
    for a, b in zip(one, two, strict=True):
        np.testing.assert_array_equal(a, b)
