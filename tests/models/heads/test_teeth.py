"""Two arches of teeth that stay whole, ride on skull and jaw, and darken inside the mouth."""

from itertools import pairwise

import numpy as np
from gemheads.models.heads.mesh import vertex_normals
from gemheads.models.heads.teeth import (
    COLUMNS,
    GAPS_MM,
    MAP_HEIGHT,
    MAP_REACH_MM,
    carried,
    make_arches,
    opacity_logit,
    paint_teeth,
)

RNG = np.random.default_rng(5)
HALF_CIRCLE = np.linspace(-1.2, 1.2, 41)
UPPER = np.stack([0.28 * np.sin(HALF_CIRCLE), 0 * HALF_CIRCLE - 0.7, 0.25 * np.cos(HALF_CIRCLE)], 1)
DOWN = np.array([0, 0.1, 0.01])
GUIDE = np.concatenate([UPPER, UPPER + DOWN, UPPER - DOWN, UPPER - 2 * DOWN])
LOWER = np.arange(len(GUIDE)) >= len(GUIDE) // 2


def test_arches_are_symmetric_and_face_the_lips() -> None:
    arches = make_arches(GUIDE, LOWER)
    half = len(arches.vertices) // 2
    upper = arches.vertices[:half].reshape(COLUMNS, -1, 3)
    np.testing.assert_allclose(upper * [-1, 1, 1], upper[::-1], atol=1e-12)
    assert arches.vertices[:half, 1].min() > arches.vertices[half:, 1].min()
    normals = vertex_normals(arches.vertices, arches.triangles)
    for row in (normals[:half], normals[half:]):
        assert row.reshape(COLUMNS, -1, 3)[COLUMNS // 2, 3, 2] > 0.9  # the incisors look forward


def test_only_the_lower_arch_follows_the_jaw() -> None:
    arches = make_arches(GUIDE, LOWER)
    turn = 0.2 * RNG.standard_normal((3, 3))
    moves = np.where(LOWER[:, None], GUIDE @ turn + [0, -0.3, 0], 0)[None]
    carried_by_jaw = carried(GUIDE, moves, LOWER, arches)[0]
    half = len(arches.vertices) // 2
    np.testing.assert_allclose(carried_by_jaw[:half], 0, atol=1e-9)
    np.testing.assert_allclose(carried_by_jaw[half:], arches.vertices[half:] @ turn + [0, -0.3, 0], atol=1e-9)


def test_teeth_darken_towards_the_cheeks_and_in_a_mouth_nearly_shut() -> None:
    picture = paint_teeth(1.0)
    crown = picture[MAP_HEIGHT // 5].mean(-1)
    middle = len(crown) // 2
    assert crown[middle - 120 : middle + 120].max() > 2 * crown[: len(crown) // 5].max()
    assert picture.max() < 0.75
    assert opacity_logit(0.1) < opacity_logit(0.45) < opacity_logit(0.9)


def test_bright_teeth_have_the_gums_of_dim_ones() -> None:
    dim, bright = paint_teeth(1.0), paint_teeth(1.3)
    np.testing.assert_allclose(bright.max(), 1.3 * dim.max(), rtol=1e-3)
    gum = MAP_HEIGHT // 80
    np.testing.assert_array_equal(bright[gum], dim[gum])


def test_crowns_are_told_apart_and_the_lower_row_is_darker() -> None:
    """In a grin as large as a head of 512 pixels; a white slab is what one takes them for otherwise."""
    bright = paint_teeth(1.0).mean(-1)
    half = MAP_HEIGHT // 2
    upper, lower = bright[int(0.42 * half)], bright[half + int(0.42 * half)]
    per_mm = len(upper) / (2 * MAP_REACH_MM)
    for row, arch in ((upper, "upper"), (lower, "lower")):
        edges = [len(row) // 2 + round(x * per_mm) for x in GAPS_MM[arch][:4]]
        for left, right in pairwise(edges):
            crown = row[left:right].max()
            assert row[left] < 0.75 * crown
            assert row[right] < 0.75 * crown
    assert lower.max() < 0.8 * upper.max()
