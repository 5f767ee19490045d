"""What the skin looks like before light: the diffuse map, enriched by everything too fine for it."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .head import Head
from .ingredients import Ingredients
from .maps import linear, load_map, sample_map
from .noise import spots, value_noise
from .people import Person

MM = 1e-3


@dataclass(frozen=True)
class SkinMaps:
    """Maps in the texture space of the base mesh."""

    diffuse: Floats
    lips: Floats
    lids: Floats
    mouth: Floats
    ears: Floats


def load_skin_maps(person: Person, ingredients: Ingredients) -> SkinMaps:
    """The person's diffuse map and MakeHuman's region masks, slightly softened."""
    masks = {}
    for name in ("lips", "eyelids", "inside-mouth", "ears"):
        masks[name] = cv2.GaussianBlur(load_map(ingredients.mpfb / "textures" / f"mpfb_{name}.jpg"), (0, 0), 2.0)
    diffuse = load_map(ingredients.makehuman / "skins" / person.skin)
    return SkinMaps(diffuse, masks["lips"], masks["eyelids"], masks["inside-mouth"], masks["ears"])


def _blob(canvas: Floats, x: float, y: float, wide: float, high: float) -> Floats:
    """A soft spot on both sides of the face, front only; millimetres from between the eyes."""
    dx = (np.abs(canvas[:, 0]) - x * MM) / (wide * MM)
    dy = (canvas[:, 1] - y * MM) / (high * MM)
    front = np.clip((canvas[:, 2] + 0.055) / 0.03, 0, 1)
    return np.exp(-(dx**2 + dy**2)) * front


def albedo(
    person: Person, maps: SkinMaps, uv: Floats, canvas: Floats, scalp: Floats, brow: Floats
) -> tuple[Floats, Floats]:
    """Linear albedo [N, 3] and oiliness [N] of skin points.

    ``uv`` [N, 2] in the base texture, ``canvas`` [N, 3] on the average head, ``scalp`` and ``brow`` [N] in [0, 1].
    """
    color = linear(sample_map(maps.diffuse, uv)[:, :3]) * np.array(person.skin_gain)
    lips = sample_map(maps.lips, uv)[:, 0]
    ears = sample_map(maps.ears, uv)[:, 0]
    dark = np.clip(color.mean(1, keepdims=True) / 0.35, 0, 1)
    tint = 0.5 + 0.5 * dark  # dark skin shows blood less

    blood = (
        0.9 * _blob(canvas, 38, -38, 17, 15) + 0.8 * _blob(canvas, 0, -42, 11, 9) + 0.4 * _blob(canvas, 0, -95, 16, 9)
    )
    blood += 0.6 * ears + 0.35 * value_noise(canvas, 9 * MM, person.seed) * _blob(canvas, 0, -30, 65, 70)
    color *= 1 + blood[:, None] * tint * np.array([0.06, -0.10, -0.09])
    tired = _blob(canvas, 31, -13, 13, 5)
    color *= 1 - tired[:, None] * np.array([0.10, 0.16, 0.10]) * tint

    coarse = value_noise(canvas, 14 * MM, person.seed + 1)
    middle = value_noise(canvas, 5 * MM, person.seed + 2)
    fine = value_noise(canvas, 2.2 * MM, person.seed + 3)
    grain = value_noise(canvas, 1.0 * MM, person.seed + 4)
    pores = np.clip(0.35 + _blob(canvas, 18, -42, 26, 24) + 0.5 * _blob(canvas, 0, 40, 45, 22), 0, 1.2)
    smooth = 1 - lips
    uneven = 0.022 * coarse + 0.022 * middle + 0.024 * fine * smooth + 0.03 * grain * pores * smooth
    color *= 1 + uneven[:, None]
    color *= 1 + (0.018 * middle + 0.012 * fine)[:, None] * np.array([0.6, -0.6, -0.9]) * smooth[:, None]

    if person.freckles:
        where = _blob(canvas, 28, -33, 34, 20) + 0.5 * _blob(canvas, 0, 40, 50, 26) + 0.12
        dots = spots(canvas, 4.4 * MM, 1.7 * MM, person.seed + 5) + 0.7 * spots(
            canvas, 7 * MM, 2.1 * MM, person.seed + 9
        )
        color *= 1 - person.freckles * np.clip(where * dots, 0, 1)[:, None] * smooth[:, None] * np.array(
            [0.30, 0.42, 0.50]
        )
    if person.wrinkles:
        color *= 1 - person.wrinkles * _wrinkles(canvas, person.seed)[:, None] * np.array([0.28, 0.36, 0.36])
        age_spots = spots(canvas, 21 * MM, 3.0 * MM, person.seed + 13) * np.clip(
            0.3 + value_noise(canvas, 40 * MM, 7), 0, 1
        )
        color *= 1 - person.wrinkles * age_spots[:, None] * np.array([0.14, 0.20, 0.25])
    if person.stubble:
        beard = beard_area(canvas) * smooth
        rough = 0.75 + 0.35 * grain + 0.35 * fine
        shade = person.stubble * (beard * np.clip(rough, 0.2, 1.6))[:, None]
        color *= 1 - shade * np.array([0.40, 0.36, 0.30])

    if np.any(lips > 0.01):
        lip_color = linear(np.array(person.lip))
        level = color.mean(1, keepdims=True) / np.maximum(
            color[lips > 0.5].mean() if np.any(lips > 0.5) else color.mean(), 1e-6
        )
        stretched = canvas * np.array([1.0, 0.22, 0.22])
        lines = value_noise(stretched, 1.1 * MM, person.seed + 21) + 0.7 * value_noise(
            stretched, 2.2 * MM, person.seed + 22
        )
        painted = lip_color * np.clip(level, 0.6, 1.3) * (1 + 0.07 * lines[:, None])
        color += (0.75 * lips)[:, None] * (painted - color)

    ink = linear(np.array(person.brow_color))
    color += (0.42 * np.clip(brow, 0, 1) ** 1.5)[:, None] * (ink * 1.2 - color)
    under_hair = linear(np.array(person.hair.color)) * 0.85
    roots = 0.9 * under_hair + 0.1 * color
    color += np.clip(scalp, 0, 1)[:, None] * (roots * (1 + 0.25 * grain[:, None]) - color)

    mouth = sample_map(maps.mouth, uv)[:, 0]
    color += mouth[:, None] * (np.array([0.20, 0.055, 0.05]) * mouth_shade(canvas)[:, None] - color)
    oil = (
        0.55
        + 0.5 * _blob(canvas, 0, -35, 13, 30)
        + 0.4 * _blob(canvas, 0, 45, 40, 25)
        + 0.25 * _blob(canvas, 40, -25, 16, 12)
    )
    oil = (oil + person.lip_gloss * lips) * (1 - 0.9 * scalp) * (1 + 0.25 * fine + 0.25 * grain * pores) * (1 - mouth)
    return np.clip(color, 0.003, 0.95), np.clip(oil, 0, 2)


def mouth_shade(canvas: Floats) -> Floats:
    """[N] in [0, 1]: how dark the mouth is at a depth; what falls in between the lips hardly reaches the throat."""
    return np.clip((canvas[:, 2] / MM + 22) / 48, 0.2, 1) ** 1.5


def beard_area(canvas: Floats) -> Floats:
    """[N] in [0, 1] where a beard grows: upper lip, chin, jaw, the top of the throat."""
    x, y, z = np.abs(canvas[:, 0]) / MM, canvas[:, 1] / MM, canvas[:, 2] / MM
    border = -58 + 0.55 * np.clip(x - 22, 0, 60)  # rises along the cheek towards the sideburn
    below = np.clip((border - y) / 8, 0, 1)
    above = np.clip((y + 150) / 25, 0, 1)
    front = np.clip((z + 75) / 25, 0, 1)
    return below * above * front


def _wrinkles(canvas: Floats, seed: int) -> Floats:
    """[N] in [0, 1]: lines on the forehead, at the eyes' corners and under them."""
    x, y = np.abs(canvas[:, 0]) / MM, canvas[:, 1] / MM
    bend = 2.5 * value_noise(canvas, 30 * MM, seed + 31) + 0.8 * value_noise(canvas, 9 * MM, seed + 32)
    rows = np.exp(-(((y + bend - 0.004 * x * x) % 9.0 - 4.5) ** 2) / 0.9)
    strength = 0.55 + 0.45 * value_noise(canvas, 22 * MM, seed + 33)
    forehead = np.exp(-(((y - 47) / 15) ** 4)) * np.exp(-((x / 38) ** 4)) * rows * np.clip(strength, 0, 1)
    angle = np.arctan2(y + 1 + 0.3 * bend, np.maximum(x - 38, 0.1))
    fan = np.exp(-(((angle * 4.2 + 0.3 * bend) % 1.0 - 0.5) ** 2) / 0.03) * (np.abs(angle) < 0.8)
    crow = fan * np.clip((x - 44) / 4, 0, 1) * np.clip((66 - x) / 12, 0, 1)
    bag = np.exp(-((y + 17 + 0.018 * (x - 32) ** 2 * -1 + 0.5 * bend) ** 2) / 2.0) * np.exp(-(((x - 31) / 15) ** 4))
    return np.clip(0.8 * forehead + 0.7 * crow + 0.6 * bag, 0, 1)


def points_of(head: Head, faces: NDArray[np.int64], weights: Floats) -> tuple[Floats, Floats, Floats]:
    """Texture coordinates [N, 2], canvas positions [N, 3] and smooth normals [N, 3] of points on the head."""
    uv = (head.texture[faces] * weights[..., None]).sum(1)
    corners = head.triangles[faces]
    canvas = (head.canvas[corners] * weights[..., None]).sum(1)
    normal = (head.normals[corners] * weights[..., None]).sum(1)
    return uv, canvas, normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
