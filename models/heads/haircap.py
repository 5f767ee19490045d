"""Short hair as one smooth cap: without stray strands, close to the neck, and round where its card has corners."""

from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from ...render.arrays import Floats, Indices
from .head import Head
from .mesh import vertex_normals
from .soup import HAIR, SKIN

CAP_TRIANGLES = 40
"""A piece of hair of fewer triangles is a single strand, which would float in the air."""
CLINGS_M = 3e-3
CLING_HEIGHTS = (-0.045, 0.02)
"""Metres: below the first hair stands at most CLINGS_M off the skin; up to the second it may more and more."""
FREE_M = 0.03
ROUNDS = 2
ROUNDNESS = 0.75
"""Of Phong tessellation (Boubekeur and Alexa 2008): 0 is flat."""


def capped(head: Head) -> Head:
    """The head with its hair made anew; hair does not move with expressions."""
    faces = _pieces(head)
    used, corners = np.unique(head.triangles[faces], return_inverse=True)
    corners = corners.reshape(-1, 3)
    skin = head.vertices[np.unique(head.triangles[head.parts == SKIN])]
    points = np.concatenate([_clung(head.vertices[used].astype(float), skin), head.canvas[used]], 1)
    texture = head.texture[faces].astype(float)
    for _ in range(ROUNDS):
        points, corners, texture = _split(points, corners, texture)
    bare = head.parts != HAIR
    count, first = len(points), len(head.vertices)
    none = np.full(count, -1, np.int8)
    return replace(
        head,
        vertices=np.concatenate([head.vertices, points[:, :3]]).astype(np.float32),
        canvas=np.concatenate([head.canvas, points[:, 3:]]).astype(np.float32),
        deltas=np.concatenate([head.deltas, np.zeros((len(head.deltas), count, 3), np.float32)], 1),
        eye_of_vertex=np.append(head.eye_of_vertex, none),
        lid_of_vertex=np.append(head.lid_of_vertex, none),
        triangles=np.concatenate([head.triangles[bare], corners + first]),
        texture=np.concatenate([head.texture[bare], texture]).astype(np.float32),
        parts=np.append(head.parts[bare], np.full(len(corners), HAIR, np.uint8)),
    )


def _pieces(head: Head) -> Indices:
    """The triangles of hair but for single strands."""
    faces = np.flatnonzero(head.parts == HAIR)
    corners = head.triangles[faces]
    ends = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]]])
    count = len(head.vertices)
    edges = sparse.coo_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(count, count))
    _, piece = csgraph.connected_components(edges, directed=False)
    size = np.bincount(piece[corners[:, 0]], minlength=piece.max() + 1)
    return faces[size[piece[corners[:, 0]]] >= CAP_TRIANGLES]


def _clung(points: Floats, skin: Floats) -> Floats:
    """Hair [P, 3] drawn in towards the skin [S, 3] where it hangs low."""
    _, nearest = cKDTree(skin).query(points)
    away = points - skin[nearest]
    distance = np.linalg.norm(away, axis=1)
    low, high = CLING_HEIGHTS
    free = np.clip((points[:, 1] - low) / (high - low), 0, 1) ** 2
    most = CLINGS_M + free * (FREE_M - CLINGS_M)
    share = np.where(free < 1, np.minimum(distance, most) / np.maximum(distance, 1e-9), 1)
    return skin[nearest] + away * share[:, None]


def _split(points: Floats, corners: Indices, texture: Floats) -> tuple[Floats, Indices, Floats]:
    """Each triangle in four. New points, [P, 3 + more] with a place first, lie where the surface would be round."""
    normals = _seamless_normals(points[:, :3], corners)
    pairs = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, edge = np.unique(pairs, axis=0, return_inverse=True)
    a, b = edges.T
    middle = (points[a] + points[b]) / 2
    round_out = np.zeros((len(edges), 3))
    for end in (a, b):
        off = ((middle[:, :3] - points[end, :3]) * normals[end]).sum(1, keepdims=True)
        round_out -= 0.5 * off * normals[end]
    middle[:, :3] += ROUNDNESS * round_out
    m = edge.reshape(-1, 3) + len(points)
    c = corners
    split = np.stack(
        [
            np.stack([c[:, 0], m[:, 0], m[:, 2]], 1),
            np.stack([m[:, 0], c[:, 1], m[:, 1]], 1),
            np.stack([m[:, 2], m[:, 1], c[:, 2]], 1),
            m,
        ],
        1,
    )
    t = (texture + np.roll(texture, -1, 1)) / 2
    quarters = np.stack(
        [
            np.stack([texture[:, 0], t[:, 0], t[:, 2]], 1),
            np.stack([t[:, 0], texture[:, 1], t[:, 1]], 1),
            np.stack([t[:, 2], t[:, 1], texture[:, 2]], 1),
            t,
        ],
        1,
    )
    return np.concatenate([points, middle]), split.reshape(-1, 3), quarters.reshape(-1, 3, 2)


def _seamless_normals(points: Floats, corners: Indices) -> Floats:
    """Normals [P, 3] that points at the same place share, as on both sides of a seam."""
    _, same = np.unique(np.round(points / 1e-5), axis=0, return_inverse=True)
    same = same.ravel()
    places = np.zeros((same.max() + 1, 3))
    places[same] = points
    return vertex_normals(places, same[corners])[same]
