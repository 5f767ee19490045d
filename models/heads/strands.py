"""Hair, lashes and brows: long thin splats along the strokes of their textures."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .brows import BrowMap, root_brows
from .head import Head
from .ingredients import Ingredients
from .light import KEY
from .maps import linear, load_map, sample_map, strokes
from .noise import value_noise
from .people import Person
from .sampling import scatter
from .shading import EXPOSURE, hair_texture, tone
from .skin import points_of
from .soup import GLINTS, HAIR, LASHES
from .splats import Rider, ride

UNDERCOAT = 0.36
"""Share of the strands that are broad and dark and lie beneath the others, so that nothing shows through."""
UNDERCOAT_SIGMA = 1.3, 0.62
"""Of a broad strand along and across, in radii of its disc."""
LONG_UNDERCOAT = 1.25
"""How much broader the undercoat of long hair is, which has only the background behind it."""
HAIR_BOTTOM = -0.235
"""Metres: long hair ends here, above the picture's lower edge."""

LASH_END = 0.0475
"""Metres from the canvas's middle: the outer corner of the eye, past which the cards fan out."""


def hair_rider(
    head: Head, person: Person, ingredients: Ingredients, light: Floats, count: int, rng: np.random.Generator
) -> Rider:
    """About ``count`` strands of hair on the hair cards; ``light`` [V, 3] is the baked irradiance."""
    image = load_map(hair_texture(person, ingredients))
    faces = np.flatnonzero(head.parts == HAIR)
    corners = head.vertices[head.triangles[faces]].astype(float)
    height = corners[..., 1].mean(1)
    density = np.where(height > HAIR_BOTTOM, 1.0, 0.0) * np.where(corners[..., 2].mean(1) < -0.06, 0.45, 1.0)
    chosen, weights, radius = scatter(corners, density, int(count * 1.35), rng)
    face = faces[chosen]
    uv, canvas, normal = points_of(head, face, weights)
    texel = sample_map(image, uv)
    solid = texel[:, 3] > 0.35
    kept = np.flatnonzero(solid)
    if len(kept) > count:
        kept = kept[np.sort(rng.permutation(len(kept))[:count])]
    face, weights, radius, uv = face[kept], weights[kept], radius[kept], uv[kept]
    canvas, normal, texel = canvas[kept], normal[kept], texel[kept]
    field = strokes(image, 11.0)
    if person.hair.combed:
        field = np.broadcast_to(np.array([-1.0, 0.0], np.float32), field.shape)
    direction = _texture_direction(head, face, uv, field)
    if person.hair.curl:
        wild = rng.standard_normal((len(face), 3))
        direction = direction + person.hair.curl * wild / np.linalg.norm(wild, axis=1, keepdims=True)
    triangle = head.triangles[face]
    position = (head.vertices[triangle] * weights[..., None]).sum(1)
    outward = normal * np.where(((position - np.array([0, 0.03, 0])) * normal).sum(1, keepdims=True) < 0, -1, 1)

    gray = texel[:, :3].mean(1)
    level = np.clip(gray / max(float(np.median(gray)), 0.02), 0.3, 2.2) ** 0.8
    lock = value_noise(canvas, 6e-3, person.seed + 60) * 0.5 + 0.35 * rng.standard_normal(len(face))
    blend = np.clip(0.35 + 0.45 * (level - 1) + 0.35 * lock, 0, 1)[:, None]
    color = linear(np.array(person.hair.color)) * (1 - blend) + linear(np.array(person.hair.tip)) * blend
    lit = (light[triangle] * weights[..., None]).sum(1)
    shine = _strand_shine(direction, outward) * person.hair.gloss * (0.6 + 0.4 * np.clip(lock + 0.5, 0, 1.5))
    linear_color = EXPOSURE * (color * lit + shine[:, None] * (0.5 * color + 0.05) * np.clip(lit, 0, 1.5))
    under = rng.random(len(face)) < UNDERCOAT
    side = np.where((outward * normal).sum(1) < 0, -1.0, 1.0)
    broad = np.array(UNDERCOAT_SIGMA) * (LONG_UNDERCOAT if person.hair.combed else 1)
    thin = radius * np.where(under, broad[1], rng.uniform(0.16, 0.26, len(face)))
    long = radius * np.where(
        under, broad[0], person.hair.length * np.minimum(rng.uniform(1.5, 2.5, len(face)), 8e-3 / radius)
    )
    # Straight strands stand off the round crown, where they would fray the silhouette.
    long *= 1 - 0.45 * np.clip(outward[:, 1] / 0.7, 0, 1) * person.hair.combed
    sigma = np.stack([long, thin, np.minimum(0.5 * thin, 0.5e-3)], 1)
    lift = side * (person.hair.grow + np.where(under, -1.2e-3, rng.uniform(-0.5e-3, 1.5e-3, len(face))))
    linear_color *= np.where(under, 0.62, 1.0)[:, None]
    return ride(
        head.vertices,
        triangle,
        weights,
        direction,
        sigma,
        np.where(under, 0.97, 0.8) * np.clip(texel[:, 3] * 1.2, 0.4, 1),
        tone(linear_color),
        np.full(len(face), HAIR),
        lift,
    )


def _texture_direction(head: Head, face: NDArray[np.int64], uv: Floats, field: Floats) -> Floats:
    """Direction in space [N, 3] of the strokes at texture points ``uv`` [N, 2] of triangles ``face`` [N]."""
    double = sample_map(0.5 + 0.5 * field, uv) * 2 - 1
    angle = 0.5 * np.arctan2(double[:, 1], double[:, 0])
    along = np.stack([np.cos(angle), np.sin(angle)], 1)
    corner_uv = head.texture[face].astype(float)
    d1, d2 = corner_uv[:, 1] - corner_uv[:, 0], corner_uv[:, 2] - corner_uv[:, 0]
    det = d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0]
    det = np.where(np.abs(det) < 1e-12, 1e-12, det)
    a = (along[:, 0] * d2[:, 1] - along[:, 1] * d2[:, 0]) / det
    b = (along[:, 1] * d1[:, 0] - along[:, 0] * d1[:, 1]) / det
    corners = head.vertices[head.triangles[face]].astype(float)
    direction = a[:, None] * (corners[:, 1] - corners[:, 0]) + b[:, None] * (corners[:, 2] - corners[:, 0])
    return direction / np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-12)


def _strand_shine(direction: Floats, outward: Floats) -> Floats:
    """Highlight of strands under the key lamp seen from the front (Kajiya and Kay 1989), on the lit side only."""
    half = KEY + np.array([0, 0, 1.0])
    half /= np.linalg.norm(half)
    along = np.clip(direction @ half, -1, 1)
    return np.sqrt(1 - along**2) ** 30 * np.clip(outward @ KEY + 0.2, 0, 1) * 1.6


def lash_rider(head: Head, person: Person, ingredients: Ingredients, count: int, rng: np.random.Generator) -> Rider:
    """Upper lashes: about ``count`` fine dark splats along the strokes of the lash cards."""
    image = load_map(ingredients.makehuman / "proxies/eyelashes/eyelashes02/textures/eyelashes02.png")
    faces = np.flatnonzero(head.parts == LASHES)
    faces = faces[head.canvas[head.triangles[faces], 1].mean(1) > 0]
    corners = head.vertices[head.triangles[faces]].astype(float)
    chosen, weights, _ = scatter(corners, np.ones(len(faces)), count * 3, rng)
    face = faces[chosen]
    uv, _, _ = points_of(head, face, weights)
    alpha = sample_map(image, uv)[:, 3]
    position = (head.canvas[head.triangles[face]] * weights[..., None]).sum(1)
    kept = np.flatnonzero((alpha > 0.5) & (np.abs(position[:, 0]) < LASH_END))
    kept = np.sort(kept[rng.permutation(len(kept))[:count]])
    face, weights, uv = face[kept], weights[kept], uv[kept]
    direction = _texture_direction(head, face, uv, strokes(image, 1.5))
    sigma = np.tile([0.8e-3, 0.09e-3, 0.08e-3], (len(face), 1))
    dark = np.tile(np.array(person.brow_color) * 0.6, (len(face), 1))
    return ride(
        head.vertices,
        head.triangles[face],
        weights,
        direction,
        sigma,
        np.full(len(face), 0.42),
        dark,
        np.full(len(face), LASHES),
    )


def glint_rider(head: Head) -> Rider:
    """The lamps mirrored in the eyes: a large and a small highlight each."""
    face = np.flatnonzero(head.parts == GLINTS)
    size = np.tile([0.62e-3, 0.38e-3], len(face) // 2)[:, None] * np.array([1, 1, 0.1])
    count = len(face)
    return ride(
        head.vertices,
        head.triangles[face],
        np.full((count, 3), 1 / 3),
        None,
        size,
        np.tile([0.92, 0.5], count // 2),
        np.ones((count, 3)),
        np.full(count, GLINTS),
    )


def brow_rider(
    head: Head, person: Person, brows: BrowMap, light: Floats, count: int, rng: np.random.Generator
) -> Rider:
    """About ``count`` brow hairs standing just off the skin."""
    face, weights, direction = root_brows(head, brows, count, rng)
    triangle = head.triangles[face]
    lit = (light[triangle] * weights[..., None]).sum(1)
    tone_of_hair = rng.uniform(0.55, 1.35, (len(face), 1))
    color = tone(EXPOSURE * linear(np.array(person.brow_color)) * tone_of_hair * np.clip(lit, 0.3, 2) * 0.9)
    sigma = np.stack(
        [rng.uniform(1.3e-3, 2.2e-3, len(face)), np.full(len(face), 0.18e-3), np.full(len(face), 0.12e-3)], 1
    )
    return ride(
        head.vertices,
        triangle,
        weights,
        direction,
        sigma,
        np.full(len(face), 0.5),
        color,
        np.full(len(face), 0),
        lift=rng.uniform(0.2e-3, 0.8e-3, len(face)),
    )
