"""The oracle against closed forms."""

import numpy as np
import pytest
from gemheads.render.camera import Camera
from gemheads.render.gaussians import Gaussians
from gemheads.render.projection import project
from gemheads.render.reference import render_reference

CAMERA = Camera(100, 100, 8.5, 8.5, 17, 17, np.eye(4))


def stack(depths: list[float], opacities: list[float], colors: list[list[float]], scale: float = 0.05) -> Gaussians:
    count = len(depths)
    positions = np.array([[0, 0, depth] for depth in depths])
    rotations = np.tile([1.0, 0, 0, 0], (count, 1))
    return Gaussians(positions, rotations, np.full((count, 3), scale), np.array(opacities), np.array(colors))


def test_one_splat_is_its_formula() -> None:
    image = render_reference(stack([1], [0.8], [[1, 0.5, 0]]), CAMERA)
    variance = (100 * 0.05) ** 2 + 0.3
    expected = 0.8 * np.exp(-0.5 * (3**2 + 2**2) / variance)
    assert image[8, 8] == pytest.approx([0.8, 0.4, 0, 0.8])
    assert image[8 + 2, 8 + 3] == pytest.approx([expected, expected / 2, 0, expected])


def test_near_hides_far() -> None:
    image = render_reference(stack([2, 1], [0.9, 0.6], [[0, 1, 0], [1, 0, 0]]), CAMERA)
    assert image[8, 8] == pytest.approx([0.6, 0.4 * 0.9, 0, 1 - 0.4 * 0.1])


def test_opacity_is_capped_and_faint_splats_are_skipped() -> None:
    assert render_reference(stack([1], [1.0], [[1, 1, 1]]), CAMERA)[8, 8, 3] == pytest.approx(0.99)
    assert not render_reference(stack([1], [0.0039], [[1, 1, 1]]), CAMERA).any()


def test_behind_the_near_plane_is_left_out() -> None:
    assert not render_reference(stack([-1, 0.009], [0.9, 0.9], [[1, 1, 1]] * 2), CAMERA).any()


def test_projection_of_a_turned_needle() -> None:
    turned = Gaussians(
        np.array([[0.1, -0.2, 2.0]]),
        np.array([[np.cos(np.pi / 8), 0, 0, np.sin(np.pi / 8)]]),  # 45 degrees about z
        np.array([[0.2, 1e-6, 1e-6]]),
        np.array([0.5]),
        np.ones((1, 3)),
    )
    centers, covariances, depths = project(turned, CAMERA)
    assert centers[0] == pytest.approx([8.5 + 5, 8.5 - 10])
    assert covariances[0] == pytest.approx(np.array([[50.3, 50], [50, 50.3]]), rel=1e-6)
    assert depths[0] == 2
