"""The pieces of a studio subject: lines that skin folds along, and hair that clings and is round."""

import numpy as np
from gemheads.models.heads.creases import creases
from gemheads.models.heads.haircap import CLINGS_M, _clung, _split


def test_creases_are_lines_on_the_front() -> None:
    x, y = np.meshgrid(np.linspace(-0.06, 0.06, 241), np.linspace(-0.1, 0.08, 361))
    flat = np.stack([x, y, 0 * x], -1).reshape(-1, 3)
    depth = creases(flat, 1)
    assert 0 <= depth.min() <= depth.max() <= 1
    assert 0.01 < (depth > 0.4).mean() < 0.12
    np.testing.assert_array_equal(creases(flat - [0, 0, 0.1], 1), 0)


def test_low_hair_clings_and_high_hair_stays() -> None:
    y = np.linspace(-0.1, 0.1, 41)
    skin = np.stack([0 * y, y, 0 * y], 1)
    hair = skin + np.array([0, 0, 0.012])
    clung = _clung(hair, skin)
    assert clung[y < -0.05, 2].max() <= CLINGS_M + 1e-9
    np.testing.assert_allclose(clung[y > 0.03], hair[y > 0.03])


def test_a_split_octahedron_is_rounder_and_keeps_its_points() -> None:
    points = np.concatenate([np.eye(3), -np.eye(3)])
    corners = np.array([[a, b, c] for a in (0, 3) for b in (1, 4) for c in (2, 5)])
    inward = np.linalg.det(points[corners]) < 0
    corners[inward] = corners[inward][:, ::-1]
    fine, triangles, texture = _split(points, corners, np.zeros((8, 3, 2)))
    np.testing.assert_array_equal(fine[:6], points)
    assert (len(fine), len(triangles), texture.shape) == (18, 32, (32, 3, 2))
    reach = np.linalg.norm(fine[6:], axis=1)
    assert reach.min() > np.sqrt(0.5) + 0.1
    assert reach.max() < 1.1
    assert (np.linalg.det(fine[triangles]) > 0).all()
