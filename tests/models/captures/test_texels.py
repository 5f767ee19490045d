"""One splat a texel: where they lie, how large they are, and how a mesh takes them along."""

from dataclasses import dataclass

import numpy as np
import pytest
from gemheads.models.captures.deformation import MAX_STRETCH
from gemheads.models.captures.texels import FOOTPRINT, Texels, texels_of
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec


@dataclass(frozen=True)
class Sheet:
    """A bent sheet of 8 x 8 vertices, 7 cm a side, that fills all of its UV map but a margin of 1/8."""

    vertices: np.ndarray
    triangles: np.ndarray
    uv: np.ndarray
    uv_triangles: np.ndarray
    parts: np.ndarray


@pytest.fixture
def sheet() -> Sheet:
    y, x = np.mgrid[:8, :8]
    flat = np.stack([x, y], -1).reshape(-1, 2) / 7
    vertices = np.column_stack([0.07 * (flat - 0.5), 0.01 * np.cos(3 * (flat[:, 0] - 0.5))])
    corner = (8 * np.arange(7)[:, None] + np.arange(7)).ravel()
    triangles = np.concatenate(
        [np.stack([corner, corner + 1, corner + 9], 1), np.stack([corner, corner + 9, corner + 8], 1)]
    )
    parts = np.repeat([0, 1], len(corner))
    return Sheet(vertices, triangles, 0.125 + 0.75 * flat, triangles, parts)


@pytest.fixture
def texels(sheet: Sheet) -> Texels:
    return texels_of(sheet, 32)


def grey(texels: Texels) -> np.ndarray:
    return np.full((len(texels), 3), 0.5, np.float32)


def test_every_covered_texel_once_the_first_row_uppermost(texels: Texels) -> None:
    rows, columns = np.divmod(texels.uv_index, 32)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (4, 27, 4, 27)
    assert len(texels) == 24 * 24 == len(set(texels.uv_index.tolist()))
    positions = texels.splats(grey(texels)).positions
    assert positions[rows == 4][:, 1].min() > positions[rows == 27][:, 1].max()
    assert positions[columns == 4][:, 0].max() < positions[columns == 27][:, 0].min()
    assert set(texels.part.tolist()) == {0, 1}


def test_splats_lie_on_the_surface_and_close_it(texels: Texels, sheet: Sheet) -> None:
    raw = texels.splats(grey(texels))
    spacing = 0.07 / 24
    inner = np.abs(raw.positions[:, :2]).max(1) < 0.02
    sigmas = np.exp(raw.log_scales[inner])
    np.testing.assert_allclose(sigmas[:, 1], FOOTPRINT * spacing, rtol=0.05)
    assert (sigmas[:, 0] >= 0.99 * FOOTPRINT * spacing).all()  # along x the sheet is bent, so longer
    assert (sigmas[:, 2] < 0.2 * sigmas[:, 0]).all()
    normal = matrix_from_wxyz(raw.wxyz)[..., 2]
    wanted = np.column_stack([0.03 / 0.07 * np.sin(3 * raw.positions[:, 0] / 0.07), 0 * normal[:, 0], 0 * normal[:, 0]])
    wanted[:, 2] = 1
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert ((normal * wanted).sum(1) > np.cos(0.15)).all()


def test_at_rest_nothing_moves(texels: Texels, sheet: Sheet) -> None:
    raw = texels.splats(grey(texels))
    same = texels.carried(raw, sheet.vertices)
    gradients, turns = texels.moved(sheet.vertices)
    np.testing.assert_allclose(gradients, np.tile(np.eye(3), (len(texels), 1, 1)), atol=1e-6)
    np.testing.assert_allclose(turns, gradients, atol=1e-6)
    for name, value in vars(raw).items():
        np.testing.assert_allclose(getattr(same, name), value, atol=1e-6, err_msg=name)


def test_a_rigid_motion_is_exact(texels: Texels, sheet: Sheet) -> None:
    turn = matrix_from_wxyz(wxyz_from_rotvec(np.array([0.4, -0.9, 0.3])))
    move = np.array([0.1, 0.2, -0.3])
    moved = sheet.vertices @ turn.T + move
    raw = texels.splats(grey(texels))
    raw.positions[:, 2] += 0.003  # off the surface
    (gradients, turns), after = texels.moved(moved), texels.carried(raw, moved)
    np.testing.assert_allclose(gradients, np.tile(turn, (len(texels), 1, 1)), atol=1e-6)
    np.testing.assert_allclose(after.positions, raw.positions @ turn.T + move, atol=1e-6)
    np.testing.assert_allclose(after.log_scales, raw.log_scales, atol=1e-5)
    np.testing.assert_allclose(matrix_from_wxyz(after.wxyz), turn @ matrix_from_wxyz(raw.wxyz), atol=1e-6)
    np.testing.assert_allclose(turns, gradients, atol=1e-6)


def test_a_stretch_is_taken_along(texels: Texels, sheet: Sheet) -> None:
    raw = texels.splats(grey(texels))
    after = texels.carried(raw, sheet.vertices * [1.5, 1, 1])
    grown = np.exp(after.log_scales - raw.log_scales)
    flat = np.abs(raw.positions[:, 0]) < 0.005
    np.testing.assert_allclose(grown[flat, 0], 1.5, rtol=0.02)
    np.testing.assert_allclose(grown[flat, 1], 1, rtol=0.02)


def test_quaternions_keep_their_sign(texels: Texels, sheet: Sheet) -> None:
    raw = texels.splats(grey(texels))
    for angle in np.linspace(-3, 3, 13):
        turn = matrix_from_wxyz(wxyz_from_rotvec(np.array([0, angle, 0])))
        assert ((texels.carried(raw, sheet.vertices @ turn.T).wxyz * raw.wxyz).sum(1) > 0).all()


@pytest.mark.parametrize("ruin", ["point", "line", "sheet inside out"])
def test_a_collapsed_mesh_tears_nothing(texels: Texels, sheet: Sheet, ruin: str) -> None:
    moved = sheet.vertices.copy()
    if ruin == "point":
        moved[:] = 0.01
    elif ruin == "line":
        moved[:, 1:] = 0
    else:
        moved[::2] *= -20
    raw = texels.splats(grey(texels))
    after = texels.carried(raw, moved)
    assert all(np.isfinite(value).all() for value in vars(after).values())
    assert np.abs(after.log_scales - raw.log_scales).max() <= np.log(2 * MAX_STRETCH)
    np.testing.assert_allclose(np.linalg.norm(after.wxyz, axis=1), 1, atol=1e-6)


def test_a_degenerate_template_triangle_is_left_out(sheet: Sheet) -> None:
    squeezed = sheet.vertices.copy()
    squeezed[9] = squeezed[8]
    texels = texels_of(Sheet(squeezed, sheet.triangles, sheet.uv, sheet.uv_triangles, sheet.parts), 32)
    gradients, _ = texels.moved(squeezed @ matrix_from_wxyz(wxyz_from_rotvec(np.array([0, 0.5, 0]))).T)
    assert np.isfinite(gradients).all()
    np.testing.assert_allclose(np.linalg.det(gradients), 1, atol=1e-5)


def test_no_texels_is_said(sheet: Sheet) -> None:
    with pytest.raises(ValueError, match="covers no texel"):
        texels_of(Sheet(sheet.vertices, sheet.triangles, sheet.uv + 5, sheet.uv_triangles, sheet.parts), 32)
