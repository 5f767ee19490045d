"""Polygon meshes of the MakeHuman data: the base mesh, its targets, and Catmull-Clark subdivision as a matrix."""

import gzip
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...render.arrays import Floats, Indices


@dataclass(frozen=True)
class QuadMesh:
    """Quads with one texture index a corner."""

    vertices: Floats
    """[V, 3]"""
    texture: Floats
    """[T, 2] u, v in [0, 1], v upwards."""
    quads: Indices
    """[Q, 4] vertex indices."""
    texture_quads: Indices
    """[Q, 4] indices into ``texture``."""


def load_base(path: Path) -> tuple[QuadMesh, NDArray[np.str_]]:
    """base.obj and the group name [Q] of each face."""
    vertices: list[list[float]] = []
    texture: list[list[float]] = []
    quads: list[list[int]] = []
    texture_quads: list[list[int]] = []
    groups: list[str] = []
    group = ""
    with path.open() as lines:
        for line in lines:
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                vertices.append([float(x) for x in words[1:4]])
            elif words[0] == "vt":
                texture.append([float(x) for x in words[1:3]])
            elif words[0] == "g":
                group = words[1]
            elif words[0] == "f":
                corners = [[int(x) - 1 for x in word.split("/")[:2]] for word in words[1:]]
                corners += corners[-1:] * (4 - len(corners))  # helper triangles: never part of a head
                quads.append([c[0] for c in corners])
                texture_quads.append([c[1] for c in corners])
                groups.append(group)
    mesh = QuadMesh(np.array(vertices), np.array(texture), np.array(quads), np.array(texture_quads))
    return mesh, np.array(groups)


def load_target(path: Path, count: int) -> Floats:
    """A MakeHuman target ("vertex dx dy dz" a line, plain or .gz) as displacements [count, 3]."""
    delta = np.zeros((count, 3))
    with gzip.open(path, "rt") if path.suffix == ".gz" else path.open() as lines:
        for line in lines:
            words = line.split()
            if len(words) == 4 and not line.startswith("#"):
                delta[int(words[0])] = [float(x) for x in words[1:]]
    return delta


def subdivide(mesh: QuadMesh) -> tuple[sparse.csr_matrix, QuadMesh]:
    """One Catmull-Clark step (Catmull and Clark 1978, with its rules for the rim).

    Returns the matrix [V', V] that maps any pose of the vertices to the finer mesh, and that mesh. Texture
    coordinates are split linearly, so seams stay where they are.
    """
    quads, count = mesh.quads, len(mesh.vertices)
    faces = len(quads)
    face_of_corner = np.repeat(np.arange(faces), 4)
    to_faces = _matrix(np.full(quads.size, 0.25), face_of_corner, quads, (faces, count))

    sides = np.stack([quads, np.roll(quads, -1, 1)], -1).reshape(-1, 2)
    edges, edge_of_side = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    edge_of_side = edge_of_side.reshape(-1, 4)
    edge_faces = _matrix(np.ones(quads.size), edge_of_side, face_of_corner, (len(edges), faces))
    ends = _matrix(np.full(edges.size, 0.5), np.repeat(np.arange(len(edges)), 2), edges, (len(edges), count))
    on_rim = _row_sums(edge_faces) != 2
    to_edges = _chosen(~on_rim) @ (0.5 * ends + 0.25 * (edge_faces @ to_faces)) + _chosen(on_rim) @ ends

    touch = (ends.T > 0).astype(float)
    valence = np.maximum(_row_sums(touch), 1)
    corner_of = _matrix(np.ones(quads.size), quads, face_of_corner, (count, faces))
    face_mean = sparse.diags(1 / np.maximum(_row_sums(corner_of), 1)) @ corner_of @ to_faces
    edge_mean = sparse.diags(1 / valence) @ touch @ ends
    smooth = sparse.diags(1 / valence) @ (face_mean + 2 * edge_mean) + sparse.diags((valence - 3) / valence)
    rim_touch = touch @ _chosen(on_rim)
    rim_mean = sparse.diags(0.5 / np.maximum(_row_sums(rim_touch), 1)) @ rim_touch @ ends
    rim = _row_sums(rim_touch) > 0
    to_vertices = _chosen(rim) @ (rim_mean + 0.5 * sparse.identity(count)) + _chosen(~rim) @ smooth
    matrix = sparse.csr_matrix(sparse.vstack([to_vertices, to_faces, to_edges]))

    middle_index = count + faces + edge_of_side
    centre_index = np.broadcast_to(count + np.arange(faces)[:, None], quads.shape)
    fine = np.stack([quads, middle_index, centre_index, np.roll(middle_index, 1, 1)], -1).reshape(-1, 4)
    corner = mesh.texture[mesh.texture_quads]
    middle = 0.5 * (corner + np.roll(corner, -1, 1))
    centre = np.broadcast_to(corner.mean(1, keepdims=True), corner.shape)
    texture = np.stack([corner, middle, centre, np.roll(middle, 1, 1)], 2).reshape(-1, 2)
    fine_mesh = QuadMesh(matrix @ mesh.vertices, texture, fine, np.arange(len(texture)).reshape(-1, 4))
    return matrix, fine_mesh


def _matrix(values: Floats, rows: Indices, columns: Indices, shape: tuple[int, int]) -> sparse.csr_matrix:
    return sparse.csr_matrix((values, (np.ravel(rows), np.ravel(columns))), shape=shape)


def _row_sums(matrix: sparse.csr_matrix) -> Floats:
    return np.asarray(matrix.sum(1)).ravel()


def _chosen(mask: NDArray[np.bool_]) -> sparse.csr_matrix:
    return sparse.csr_matrix(sparse.diags(mask.astype(float)))


def triangulate(quads: Indices) -> Indices:
    """[2 Q, 3] triangles of quads [Q, 4]: corners 0 1 2 and 0 2 3."""
    return np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], 1).reshape(-1, 3)


def vertex_normals(vertices: Floats, triangles: Indices) -> Floats:
    """Area-weighted unit normals [V, 3]."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, triangles[:, k], face)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
