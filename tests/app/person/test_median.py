import numpy as np
from gemheads.app.person.median import geometric_median
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.optimize import minimize


def cost(middle: np.ndarray, points: np.ndarray) -> float:
    return float(np.linalg.norm(points - middle, axis=1).sum())


@example(364, 4, 2)  # creeps towards one of the points
@given(st.integers(0, 10_000), st.integers(1, 12), st.integers(1, 4))
def test_no_other_point_is_nearer_to_all(seed: int, count: int, dimensions: int) -> None:
    points = np.random.default_rng(seed).normal(size=(count, dimensions))
    best = minimize(cost, points.mean(0), args=(points,), method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-9})
    assert cost(geometric_median(points), points) <= best.fun * (1 + 1e-4)


def test_it_is_the_point_where_most_are() -> None:
    points = np.array([[1.0, 2.0]] * 5 + [[100.0, -50.0]] * 4)
    assert np.allclose(geometric_median(points), [1.0, 2.0], atol=1e-4)
    assert np.allclose(geometric_median(points[:1]), [1.0, 2.0])


def test_a_far_point_does_not_drag_it() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(30, 8))
    calm = geometric_median(points)
    points[0] = 1e6
    assert np.abs(geometric_median(points) - calm).max() < 0.2
