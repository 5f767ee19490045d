"""One person as splats: how many go where, and what each looks like."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...render.arrays import Floats
from ...render.camera import orbit
from ..captures.meshview import see
from .collar import collar_height, neckline
from .expressions import weights_of
from .head import Head
from .ingredients import Ingredients
from .maps import sample_map
from .neckband import neckband_rider
from .sampling import scatter
from .shading import Shader
from .skin import points_of
from .soup import EYES, HAIR, SKIN, TEETH, TONGUE
from .splats import Rider, joined, ride
from .strands import brow_rider, glint_rider, hair_rider, lash_rider
from .veil import Veil, veil_of

SHARES = {"lashes": 0.012, "brows": 0.026}
"""Parts of the budget that are strands; the rest lies on surfaces."""
MOST = {"lashes": 300, "brows": 640}
"""However large the budget: hairs keep their size, so more of them would close to a black bar."""
TANGENT_SIGMA = 0.66
NORMAL_SIGMA = 0.08
NARROWEST = 0.25
"""Of a surface splat, in mean distances to its six neighbours; NARROWEST across the neckline, beside it."""
BOTTOM = -0.235
"""Metres: where the shoulders end; they fade over FADE above it."""
FADE = 0.045
WALL_AT_LIPS, BEHIND_LIPS_M = 5.0, 4.5e-3
"""Relative density that the mouth's walls gain at the lips, and the distance from the lips over which they lose it. As
sparse there as deeper in, a splat is as large as a lip is high and stands out over its edge, before the teeth."""
PROBES = (
    weights_of(),
    weights_of(jawOpen=0.9),
    weights_of(mouthSmile=1, jawOpen=0.25, mouthUpperUp=0.7, mouthLowerDown=0.7),
    weights_of(eyeBlink=1),
    weights_of(eyeLookUpLeft=1, eyeLookUpRight=1, eyeWide=1, mouthPucker=1),
    weights_of(eyeLookOutLeft=1, eyeLookInRight=1, eyeLookDownLeft=0.7, eyeLookDownRight=0.7),
    weights_of(eyeLookInLeft=1, eyeLookOutRight=1, mouthFunnel=1, jawOpen=0.4),
)


def visible_faces(head: Head) -> NDArray[np.bool_]:
    """[F] which triangles of the surfaces any allowed view sees in some expression."""
    seen = np.zeros(len(head.triangles), bool)
    solid = np.flatnonzero(np.isin(head.parts, (SKIN, EYES, TEETH, TONGUE)))
    for weights in PROBES:
        vertices = head.pose(weights)
        for yaw in (-75, -40, 0, 40, 75) if weights.any() else (-180, -130, -90, -60, -30, 0, 30, 60, 90, 130):
            for pitch in (-25, 0, 25):
                camera = orbit((0, -0.02, 0.02), 1.2, yaw, pitch, 26, 640, 640)
                found, _, _ = see(vertices, head.triangles[solid], camera)
                seen[solid[np.unique(found[found >= 0])]] = True
    return seen


def importance(shader: Shader, seen: NDArray[np.bool_]) -> Floats:
    """Relative density [F] of surface splats."""
    head = shader.head
    middle = np.full((len(head.triangles), 3), 1 / 3)
    uv, canvas, _ = points_of(head, np.arange(len(head.triangles)), middle)
    corners = head.triangles
    position = head.vertices[corners].mean(1)
    skin = head.parts == SKIN
    density = np.full(len(corners), 0.65)
    face = np.exp(-(((canvas[:, 0]) / 0.062) ** 4 + ((canvas[:, 1] + 0.035) / 0.085) ** 4)) * (canvas[:, 2] > -0.035)
    density += 2.6 * face
    x, y = np.abs(canvas[:, 0]), canvas[:, 1]
    density += 4.0 * np.exp(-(((x - 0.031) / 0.021) ** 4 + (y / 0.013) ** 4)) * (canvas[:, 2] > -0.02)
    density += 2.5 * np.exp(-((x / 0.032) ** 4 + ((y + 0.068) / 0.020) ** 4)) * (canvas[:, 2] > -0.01)
    density += 10.0 * sample_map(shader.maps.lids, uv)[:, 0] + 7.0 * sample_map(shader.maps.lips, uv)[:, 0]
    density += 1.2 * sample_map(shader.maps.ears, uv)[:, 0]
    density *= 1 - 0.35 * np.clip(canvas[:, 1] / 0.06, 0, 1)
    density = np.where(shader.scalp[corners].mean(1) > 0.6, 0.28, density)
    collar = collar_height(position)
    density = np.where(collar < 0, 0.2, density) + shader.person.neckline * np.exp(-((collar / 0.006) ** 2))
    wall = sample_map(shader.maps.mouth, uv)[:, 0] > 0.5
    red = cKDTree(canvas[skin & (sample_map(shader.maps.lips, uv)[:, 0] > 0.5)])
    density[wall] = 0.5 + WALL_AT_LIPS * np.exp(-((red.query(canvas[wall])[0] / BEHIND_LIPS_M) ** 4))
    density = np.where(skin, density, 0)
    density[head.parts == EYES] = 12.0
    density[head.parts == TEETH] = 7.0
    density[head.parts == TONGUE] = 3.0
    rest = _areas(head.vertices, corners)
    grown = np.ones(len(corners))
    for weights in PROBES[1:4]:
        grown = np.maximum(grown, _areas(head.pose(weights), corners) / np.maximum(rest, 1e-12))
    density *= np.clip(grown, 1, 6)
    low = head.vertices[corners][..., 1].max(1) < BOTTOM
    solid = np.isin(head.parts, (SKIN, EYES, TEETH, TONGUE))
    wide = np.abs(position[:, 0]) > 0.21
    return np.where(seen & solid & ~low & ~wide, density, 0)


def surface_rider(shader: Shader, seen: NDArray[np.bool_], count: int, rng: np.random.Generator) -> Rider:
    """About ``count`` even splats on those triangles of skin, eyes, teeth and tongue that are ``seen`` [F]."""
    head = shader.head
    density = importance(shader, seen)
    faces = np.flatnonzero(density > 0)
    corners = head.vertices[head.triangles[faces]].astype(float)
    chosen, weights, _ = scatter(corners, density[faces], count, rng)
    face = faces[chosen]
    position = (head.vertices[head.triangles[face]] * weights[..., None]).sum(1)
    fade = np.clip((position[:, 1] - BOTTOM) / FADE, 0, 1)
    fade *= np.clip((0.21 - np.abs(position[:, 0])) / 0.03, 0, 1)
    kept = fade > 0.03
    face, weights, fade = face[kept], weights[kept], fade[kept]
    spacing = _spacing(position[kept], head.parts[face])
    sigma = spacing[:, None] * np.array([TANGENT_SIGMA, TANGENT_SIGMA, NORMAL_SIGMA])
    # beside the neckline they lie along it and do not reach over it
    corner = head.vertices[head.triangles[face]].astype(float)
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
    above, along = neckline(position[kept], normal)
    beside = (head.parts[face] == SKIN) & (np.abs(above) < 2 * spacing)
    narrow = np.clip(0.5 * np.abs(above) / spacing, NARROWEST, TANGENT_SIGMA)
    sigma[beside, 1] = (narrow * spacing)[beside]
    return ride(
        head.vertices,
        head.triangles[face],
        weights,
        np.where(beside[:, None], along, corner[:, 1] - corner[:, 0]),
        sigma,
        0.99 * fade,
        shader.color(face, weights),
        head.parts[face],
    )


def compose(shader: Shader, ingredients: Ingredients, count: int, seed: int) -> tuple[Rider, Veil]:
    """At most ``count`` splats of one person, surfaces first, then strands, then the veil; and the neckband, which
    takes none from the face. And what draws the veil."""
    rng = np.random.default_rng(seed)
    head, person = shader.head, shader.person
    hair = hair_rider(head, person, ingredients, shader.light, int(person.hair.share * count), rng)
    hairs = {name: min(int(share * count), MOST[name]) for name, share in SHARES.items()}
    lashes = lash_rider(head, person, ingredients, hairs["lashes"], rng)
    brows = brow_rider(head, person, shader.brows, shader.light, hairs["brows"], rng)
    glints = glint_rider(head)
    seen = visible_faces(head)
    veil = veil_of(shader, seen, rng)
    others = len(hair) + len(lashes) + len(brows) + len(glints) + len(veil.rider)
    surface = surface_rider(shader, seen, count - others, rng)
    return joined([surface, neckband_rider(shader, seen), brows, lashes, hair, glints, veil.rider]), veil


def _spacing(position: Floats, part: NDArray[np.uint8]) -> Floats:
    """[N] mean distance to the six nearest splats of the same part."""
    spacing = np.zeros(len(position))
    for one in np.unique(part):
        members = np.flatnonzero(part == one)
        distance, _ = cKDTree(position[members]).query(position[members], k=min(7, len(members)))
        spacing[members] = distance[:, 1:].mean(1)
    return spacing


def _areas(vertices: Floats, triangles: NDArray[np.int64]) -> Floats:
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


__all__ = ["HAIR", "compose", "importance", "surface_rider", "visible_faces"]
