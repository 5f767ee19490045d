"""Shade that expressions bring: skin that turns from the light, lines where it is pushed together, splats for both."""

import numpy as np
import pytest
from gemheads.models.heads.darkening import LINE_DARKENS, Darkening
from gemheads.models.heads.head import Head
from gemheads.models.heads.soup import SKIN
from gemheads.models.heads.splats import ride
from gemheads.models.heads.veil import GAMMA, LEFT, OVERLAP, THICKEST, THINNEST, Veil, opacity


def sheet() -> Head:
    """Skin as flat as paper between and above the eyes, a vertex every two millimetres."""
    x, y = np.meshgrid(np.arange(-30, 31, 2) * 1e-3, np.arange(-6, 31, 2) * 1e-3)
    points = np.stack([x, y, np.zeros_like(x)], -1).reshape(-1, 3).astype(np.float32)
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([c, b, d], -1)]).reshape(-1, 3)
    return Head(
        vertices=points,
        deltas=np.zeros((52, len(points), 3), np.float32),
        eye_centers=np.zeros((2, 3), np.float32),
        eye_axes=np.zeros((2, 3), np.float32),
        eye_radius=0.012,
        eye_of_vertex=np.full(len(points), -1, np.int8),
        lid_of_vertex=np.full(len(points), -1, np.int8),
        triangles=triangles,
        texture=np.zeros((len(triangles), 3, 2), np.float32),
        parts=np.full(len(triangles), SKIN, np.uint8),
        canvas=points,
        lip_rim=np.zeros(3, np.int64),
    )


def lost(head: Head, posed: np.ndarray, wrinkles: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """At every vertex: in shadows, in lines."""
    pytest.importorskip("embreex", reason="the ray tracer of the extra 'avatars' is not installed")
    everywhere = np.arange(len(head.vertices))
    corners, weights = np.stack([everywhere] * 3, 1), np.tile([1.0, 0, 0], (len(everywhere), 1))
    return Darkening(head, wrinkles, everywhere).lost(posed, corners, weights)


def test_a_face_at_rest_loses_no_light() -> None:
    head = sheet()
    for share in lost(head, head.vertices):
        assert np.abs(share).max() < 1e-6


def test_brows_pushed_together_draw_lines_between_them_and_deeper_ones_on_wrinkled_skin() -> None:
    head = sheet()
    frowning = head.vertices * np.array([0.75, 1, 1], np.float32)
    _, young = lost(head, frowning)
    _, old = lost(head, frowning, wrinkles=1.0)
    x, y = np.abs(head.canvas[:, 0]) * 1e3, head.canvas[:, 1] * 1e3
    line, beside = (np.abs(x - 6) < 3) & (np.abs(y - 16) < 6), (np.abs(x - 22) < 3) & (np.abs(y - 16) < 6)
    assert young[line].max() > 0.5 * LINE_DARKENS[0]
    assert young[beside].max() < 0.1 * young[line].max()
    assert young.max() <= LINE_DARKENS[0]
    np.testing.assert_allclose(old, young * LINE_DARKENS[1] / LINE_DARKENS[0])


def test_skin_that_turns_from_the_light_darkens() -> None:
    head = sheet()
    bowed = head.vertices.copy()
    low = bowed[:, 1] < 0.012
    bowed[low, 2] -= 2 * (0.012 - bowed[low, 1])  # falls away below a ridge
    shadow, _ = lost(head, bowed)
    middle = np.abs(head.canvas[:, 0]) < 0.02
    assert shadow[middle & (head.canvas[:, 1] < 0.004)].mean() > 0.1
    assert abs(shadow[middle & (head.canvas[:, 1] > 0.022)]).mean() < 0.03


def test_splats_over_each_other_take_the_light_that_is_lost() -> None:
    shares = np.array([0.1, 0.2, 0.3])
    covered = 1 - (1 - opacity(shares)) ** OVERLAP
    left = LEFT.mean() ** (1 / GAMMA)
    np.testing.assert_allclose((1 - covered * (1 - left)) ** GAMMA, 1 - shares, atol=1e-6)
    assert opacity(np.array([0.0, 0.99])).tolist() == [THINNEST, THICKEST]


def test_a_veil_is_drawn_by_weights_and_let_through_without() -> None:
    one = np.array([[0, 1, 2]])
    rider = ride(
        np.eye(3), one, np.full((1, 3), 1 / 3), None, np.ones((1, 3)), np.ones(1) * 0.1, np.ones((1, 3)), one[0, :1]
    )
    slopes = np.zeros((52, 1), np.float32)
    slopes[3] = 4.0
    veil = Veil(rider, slopes)
    smiling = np.zeros(52)
    smiling[3] = 0.5
    shares = [1 / (1 + np.exp(-veil.logits(weights))) for weights in (np.zeros(52), smiling, 4 * smiling)]
    np.testing.assert_allclose(shares[0], THINNEST, rtol=1e-5)
    np.testing.assert_allclose(shares[1] / (1 - shares[1]), THINNEST / (1 - THINNEST) * np.exp(2), rtol=1e-4)
    np.testing.assert_allclose(shares[2], THICKEST, rtol=1e-5)
