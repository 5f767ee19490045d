"""Splats that ride on triangles."""

import numpy as np
import pytest
from gemheads.models.heads.splats import Rider, joined, posed, ride
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec

TRIANGLE = np.array([[0, 0, 0], [0.02, 0, 0], [0.003, 0.015, 0.004]], np.float32)


def rider(direction: np.ndarray | None = None, lift: float = 0.0) -> Rider:
    return ride(
        TRIANGLE,
        np.array([[0, 1, 2]]),
        np.array([[0.5, 0.3, 0.2]]),
        direction,
        np.array([[2e-3, 1e-3, 1e-4]]),
        np.array([0.8]),
        np.array([[0.1, 0.2, 0.3]]),
        np.array([0], np.uint8),
        lift,
    )


def test_at_rest_the_splat_is_what_was_asked_for() -> None:
    raw = posed(rider(), TRIANGLE)
    np.testing.assert_allclose(raw.positions[0], [0.5, 0.3, 0.2] @ TRIANGLE, atol=1e-8)
    np.testing.assert_allclose(np.exp(raw.log_scales[0]), [2e-3, 1e-3, 1e-4], rtol=1e-5)
    np.testing.assert_allclose(1 / (1 + np.exp(-raw.opacity_logits)), 0.8, rtol=1e-6)
    normal = np.cross(TRIANGLE[1], TRIANGLE[2])
    np.testing.assert_allclose(matrix_from_wxyz(raw.wxyz)[0, :, 2], normal / np.linalg.norm(normal), atol=1e-6)


def test_the_tangent_follows_the_direction_asked_for() -> None:
    direction = np.array([[0.3, 1.0, 0.2]])
    axis = matrix_from_wxyz(posed(rider(direction), TRIANGLE).wxyz)[0, :, 0]
    normal = np.cross(TRIANGLE[1], TRIANGLE[2])
    normal /= np.linalg.norm(normal)
    wanted = direction[0] - (direction[0] @ normal) * normal
    np.testing.assert_allclose(axis, wanted / np.linalg.norm(wanted), atol=1e-6)


def test_lift_is_along_the_normal() -> None:
    step = posed(rider(lift=1e-3), TRIANGLE).positions - posed(rider(), TRIANGLE).positions
    np.testing.assert_allclose(np.linalg.norm(step), 1e-3, rtol=1e-4)


@pytest.mark.parametrize("angle", [0.4, 1.9, 3.0])
def test_turning_the_mesh_turns_the_splat(angle: float) -> None:
    turn = matrix_from_wxyz(wxyz_from_rotvec(np.array([0.3, -0.5, 0.81]) * angle))
    before, after = posed(rider(), TRIANGLE), posed(rider(), (TRIANGLE @ turn.T).astype(np.float32))
    np.testing.assert_allclose(after.positions[0], turn @ before.positions[0], atol=1e-7)
    np.testing.assert_allclose(matrix_from_wxyz(after.wxyz)[0], turn @ matrix_from_wxyz(before.wxyz)[0], atol=2e-5)
    np.testing.assert_allclose(after.log_scales, before.log_scales, atol=1e-4)


def test_stretching_the_skin_stretches_the_splat_that_way_only() -> None:
    flat = np.array([[0, 0, 0], [0.01, 0, 0], [0, 0.01, 0]], np.float32)
    one = ride(
        flat,
        np.array([[0, 1, 2]]),
        np.full((1, 3), 1 / 3),
        np.array([[1.0, 0, 0]]),
        np.full((1, 3), 1e-3),
        np.array([0.5]),
        np.zeros((1, 3)),
        np.zeros(1, np.uint8),
    )
    wide = posed(one, flat * np.array([2, 1, 1], np.float32))
    np.testing.assert_allclose(np.exp(wide.log_scales[0]), [2e-3, 1e-3, 1e-3], rtol=1e-5)


def test_sets_are_joined_and_chosen() -> None:
    both = joined([rider(), rider(lift=1e-3)])
    assert len(both) == 2
    assert both.chosen(np.array([1])).lift[0] == np.float32(1e-3)
