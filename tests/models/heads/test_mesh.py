"""Catmull-Clark subdivision and normals."""

import numpy as np
from gemheads.models.heads.mesh import QuadMesh, load_base, load_target, subdivide, triangulate, vertex_normals

CUBE = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
CUBE_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def mesh(vertices: np.ndarray, quads: np.ndarray) -> QuadMesh:
    corners = np.arange(quads.size).reshape(-1, 4)
    return QuadMesh(vertices, np.random.default_rng(0).random((quads.size, 2)), quads, corners)


def test_a_cube_becomes_the_known_rounder_solid() -> None:
    matrix, fine = subdivide(mesh(CUBE, CUBE_QUADS))
    assert fine.quads.shape == (24, 4)
    np.testing.assert_allclose(np.asarray(matrix.sum(1)), 1)
    np.testing.assert_allclose(fine.vertices[:8], CUBE * 5 / 9)  # Catmull and Clark 1978
    np.testing.assert_allclose(np.linalg.norm(fine.vertices[8:14], axis=1), 1)  # face points
    np.testing.assert_allclose(np.linalg.norm(fine.vertices[14:], axis=1), 0.75 * np.sqrt(2))  # edge points


def test_a_flat_sheet_keeps_its_rim_and_its_plane() -> None:
    y, x = np.mgrid[:3, :3]
    sheet = np.stack([x.ravel(), y.ravel(), np.zeros(9)], 1).astype(float)
    quads = np.array([[r * 3 + c, r * 3 + c + 1, (r + 1) * 3 + c + 1, (r + 1) * 3 + c] for r in (0, 1) for c in (0, 1)])
    _, fine = subdivide(mesh(sheet, quads))
    assert np.all(fine.vertices[:, 2] == 0)
    np.testing.assert_allclose(fine.vertices[1], [1, 0, 0])  # the middle of a straight rim stays
    np.testing.assert_allclose(fine.vertices[4], [1, 1, 0])


def test_texture_is_split_with_the_corners() -> None:
    coarse = mesh(CUBE, CUBE_QUADS)
    _, fine = subdivide(coarse)
    corner = coarse.texture[coarse.texture_quads[2]]
    np.testing.assert_allclose(fine.texture[fine.texture_quads[2 * 4 + 1]][2], corner.mean(0))
    np.testing.assert_allclose(fine.texture[fine.texture_quads[2 * 4 + 1]][0], corner[1])


def test_normals_of_a_cube_point_outwards_or_inwards_alike() -> None:
    normals = vertex_normals(CUBE, triangulate(CUBE_QUADS))
    side = (normals * CUBE).sum(1)
    assert np.all(np.sign(side) == np.sign(side[0]))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)


def test_files_are_read(tmp_path) -> None:
    obj = tmp_path / "base.obj"
    obj.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng body\nf 1/1 2/2 3/3 4/4\n")
    base, groups = load_base(obj)
    assert base.quads.tolist() == [[0, 1, 2, 3]]
    assert groups.tolist() == ["body"]
    target = tmp_path / "smile.target"
    target.write_text("# a comment\n2 0.5 0 -1\n")
    np.testing.assert_array_equal(load_target(target, 4)[2], [0.5, 0, -1])
