"""Soft baked light: what a portrait studio sends to each point, less what the head blocks, spread under the skin."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ...render.arrays import Floats
from .head import Head
from .mesh import vertex_normals
from .soup import HAIR, LASHES, SKIN, TEETH, TONGUE

LAMPS = (
    # direction to the lamp, colour, concentration (von Mises-Fisher): key, fill, sky, two rims, floor
    ((-0.50, 0.50, 0.80), (2.35, 2.25, 2.12), 9.0),
    ((0.80, 0.10, 0.70), (0.62, 0.66, 0.72), 4.0),
    ((0.00, 1.00, 0.25), (0.55, 0.57, 0.62), 2.0),
    ((0.85, 0.45, -0.55), (1.25, 1.28, 1.35), 9.0),
    ((-0.85, 0.35, -0.65), (0.55, 0.58, 0.65), 8.0),
    ((0.00, -1.00, 0.50), (0.26, 0.22, 0.20), 2.0),
)
AMBIENT = np.array([0.42, 0.43, 0.45])
KEY = np.array(LAMPS[0][0]) / np.linalg.norm(LAMPS[0][0])
BOUNCE = np.array([0.34, 0.23, 0.19])
"""What a blocked direction still sends: light from other skin."""
THROUGH_HAIR = 0.35
RAYS_ACROSS = 12
"""From each point go so many rays squared."""
TEETH_LIGHT = (0.95, 1.25)
"""Bounds of the irradiance on teeth: how it falls off inside the mouth is painted (see teeth.paint_teeth)."""
SPREAD_M = (0.0042, 0.0019, 0.0012)
"""How far red, green and blue travel under the skin."""


def environment(directions: Floats) -> Floats:
    """Radiance [..., 3] from unit ``directions`` [..., 3]."""
    light = np.broadcast_to(AMBIENT, directions.shape).copy()
    for toward, color, width in LAMPS:
        unit = np.array(toward) / np.linalg.norm(toward)
        light += np.exp(width * (directions @ unit - 1))[..., None] * color
    return light


def irradiance(
    head: Head,
    vertices: Floats,
    cards: NDArray[np.bool_],
    of: NDArray[np.int64] | None = None,
    across: int = RAYS_ACROSS,
) -> Floats:
    """Irradiance / pi [V, 3] at the vertices of one pose, blocked by skin and mouth, dimmed by hair ``cards`` [F].

    ``of``: at these vertices [M] only, in their order; then [M, 3].
    """
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    solid, veil = EmbreeScene(), EmbreeScene()
    blocks = np.isin(head.parts, (SKIN, TEETH, TONGUE))
    TriangleMesh(solid, np.ascontiguousarray(vertices[head.triangles[blocks]], np.float32))
    TriangleMesh(veil, np.ascontiguousarray(vertices[head.triangles[cards]], np.float32))

    members = np.arange(len(vertices)) if of is None else of
    points, normals = vertices[members], vertex_normals(vertices.astype(float), head.triangles)[members]
    shell = np.isin(part_of_vertex(head)[members], (HAIR, LASHES))
    outward = normals.copy()
    center = np.array([0, 0.03, 0.0])
    flip = shell & (((points - center) * normals).sum(1) < 0)
    outward[flip] *= -1
    rng = np.random.default_rng(1)
    u, v = np.meshgrid(np.arange(across), np.arange(across), indexing="ij")
    total = np.zeros((len(points), 3))
    tangent, bitangent = _tangents(outward)
    origin = points + outward * 4e-4
    for i, j in zip(u.ravel(), v.ravel(), strict=True):
        r = (i + rng.random(len(points))) / across
        angle = 2 * np.pi * (j + rng.random(len(points))) / across
        ring = np.sqrt(r)
        direction = (
            (ring * np.cos(angle))[:, None] * tangent
            + (ring * np.sin(angle))[:, None] * bitangent
            + np.sqrt(1 - r)[:, None] * outward
        )
        start, toward = origin.astype(np.float32), direction.astype(np.float32)
        light = environment(direction)
        behind_hair = veil.run(start, toward, query="OCCLUDED") >= 0
        light[behind_hair & ~shell] *= THROUGH_HAIR
        light[behind_hair & shell] *= 0.75
        light[solid.run(start, toward, query="OCCLUDED") >= 0] = BOUNCE
        total += light
    return total / across**2


def part_of_vertex(head: Head) -> NDArray[np.uint8]:
    """[V] the part each vertex belongs to."""
    part = np.zeros(len(head.vertices), np.uint8)
    part[head.triangles] = head.parts[:, None]
    return part


def spread_under_skin(head: Head, light: Floats) -> Floats:
    """Irradiance [V, 3] after subsurface scattering: implicit diffusion over the surface, widest in red."""
    part = part_of_vertex(head)
    skin = np.flatnonzero(np.isin(part, (SKIN, TONGUE)))
    index = np.full(len(part), -1)
    index[skin] = np.arange(len(skin))
    triangles = index[head.triangles[np.isin(head.parts, (SKIN, TONGUE))]]
    edges = np.unique(
        np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1), axis=0
    )
    points = head.vertices[skin]
    squared = ((points[edges[:, 0]] - points[edges[:, 1]]) ** 2).sum(1)
    stiffness = 1 / np.maximum(squared, 1e-9)
    rows, columns = np.concatenate([edges, edges[:, ::-1]]).T
    adjacency = sparse.csr_matrix((np.tile(stiffness, 2), (rows, columns)), shape=(len(skin), len(skin)))
    degree = np.asarray(adjacency.sum(1)).ravel()
    neighbours = np.bincount(rows, minlength=len(skin))
    # A regular triangle grid's Laplacian is (4 / n) sum (x_j - x_i) / h^2, hence the valence below.
    laplacian = sparse.diags(4 / np.maximum(neighbours, 1)) @ (adjacency - sparse.diags(degree))
    result = light.copy()
    for channel, distance in enumerate(SPREAD_M):
        step = sparse.identity(len(skin)) - (distance**2 / 2) * laplacian
        result[skin, channel] = splu(step.tocsc()).solve(light[skin, channel])
    return result


def bake(
    head: Head,
    poses: tuple[Floats, Floats, Floats],
    cards: NDArray[np.bool_],
    mouth: Floats,
    lids: Floats,
    lips: Floats,
) -> Floats:
    """Irradiance [V, 3] that serves all expressions, but not on eyes (see ``eyelight``).

    ``poses`` are the vertices [V, 3] with the mouth open, with the eyes shut, and with the lips pursed; ``cards`` [F]
    is opaque hair; ``mouth``, ``lids`` and ``lips`` [V] in [0, 1] say how far a vertex takes its light from these.
    """
    pose_open, pose_shut, pose_pursed = poses
    neutral = irradiance(head, head.vertices, cards)
    opened = irradiance(head, pose_open, cards)
    shut = irradiance(head, pose_shut, cards)
    turned_out = irradiance(head, pose_pursed, cards)
    part = part_of_vertex(head)
    inside = np.maximum(mouth, np.isin(part, (TEETH, TONGUE)))[:, None]
    light = neutral + inside * (opened - neutral)
    light += 0.55 * lips[:, None] * (1 - inside) * np.maximum(turned_out - neutral, 0)
    light += 0.6 * lids[:, None] * (shut - neutral)
    teeth = part == TEETH
    light[teeth] = np.clip(light[teeth], *TEETH_LIGHT)
    return spread_under_skin(head, light)


def _tangents(normals: Floats) -> tuple[Floats, Floats]:
    helper = np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]])
    tangent = np.cross(helper, normals)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    return tangent, np.cross(normals, tangent)
