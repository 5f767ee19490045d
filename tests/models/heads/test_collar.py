"""The neckline on a mesh: where it is found, and how points measure their way to it."""

import numpy as np
from gemheads.models.heads.collar import collar_height, level_line, neckline

RADIUS = 0.06


def neck(rings: int = 24, sides: int = 48) -> tuple[np.ndarray, np.ndarray]:
    """Corners [F, 3, 3] of an upright cylinder around the neckline, and the height of each corner above a level."""
    y, around = np.meshgrid(np.linspace(-0.25, -0.08, rings), np.linspace(-np.pi, np.pi, sides + 1), indexing="ij")
    grid = np.stack([RADIUS * np.sin(around), y, RADIUS * np.cos(around)], -1)
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, :-1], grid[1:, 1:]
    corners = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3, 3), np.stack([c, b, d], 2).reshape(-1, 3, 3)])
    return corners, collar_height(corners.reshape(-1, 3)).reshape(-1, 3)


def test_points_lie_on_the_line_one_step_apart_and_look_along_it() -> None:
    corners, heights = neck()
    face, weights, direction = level_line(corners, heights, step=4e-3)
    points = (corners[face] * weights[..., None]).sum(1)
    assert np.abs((heights[face] * weights).sum(1)).max() < 1e-12
    np.testing.assert_allclose(weights.sum(1), 1)
    assert weights.min() >= 0
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    np.testing.assert_allclose(steps, 4e-3, rtol=0.03)  # straight lines across the bends of the line
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1)
    onward = np.diff(points, axis=0) / steps[:, None]
    assert np.abs((onward * direction[1:]).sum(1)).min() > 0.98
    assert len(points) * 4e-3 > 2 * np.pi * RADIUS


def test_a_shifted_row_lies_between_the_points_of_the_other() -> None:
    corners, heights = neck()
    face, weights, _ = level_line(corners, heights, step=4e-3)
    between, between_weights, _ = level_line(corners, heights, step=4e-3, shift=0.5)
    first = (corners[face] * weights[..., None]).sum(1)[:-1]
    second = (corners[between] * between_weights[..., None]).sum(1)[: len(first)]
    np.testing.assert_allclose(np.linalg.norm(second - first, axis=1), 2e-3, rtol=0.05)


def test_a_mesh_without_a_neckline_has_no_points() -> None:
    corners, heights = neck()
    for away in (heights + 1, heights - 1):
        face, weights, direction = level_line(corners, away, step=4e-3)
        assert len(face) == len(weights) == len(direction) == 0


def test_distance_to_the_neckline_is_measured_on_the_surface() -> None:
    slope = np.array([[0.0, 0.6, 0.8]])  # of a chest that falls away to the front
    flat = np.array([[0.01, -0.17, 0.06]])
    above, along = neckline(flat, slope)
    assert abs((along * slope).sum()) < 1e-12
    uphill = np.cross(along, slope)
    uphill *= np.sign(uphill[:, 1:2])
    further, _ = neckline(flat + 2e-3 * uphill, slope)
    np.testing.assert_allclose(further - above, 2e-3, rtol=0.02)
    beside, _ = neckline(flat + 1e-3 * along, slope)
    np.testing.assert_allclose(beside, above, atol=2e-5)
