"""Brows: where the hairs stand and which way they lie, from a MakeHuman brow card seen from the front."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.camera import Camera
from ..captures.meshview import see
from .head import Head
from .ingredients import Ingredients
from .maps import load_map, sample_map, strokes
from .mesh import load_base
from .people import Person
from .proxies import load_proxy
from .soup import SKIN

PIXEL = 0.25e-3
"""Metres a pixel of the frontal map."""
WIDTH, HEIGHT = 560, 240
"""Pixels: 140 x 60 mm around the eyes' middle."""


@dataclass(frozen=True)
class BrowMap:
    """The brows of one person on the canvas, seen from the front."""

    density: NDArray[np.float32]
    """[HEIGHT, WIDTH] how much hair, 0..1, smoothed."""
    direction: NDArray[np.float32]
    """[HEIGHT, WIDTH, 2] cos and sin of twice the angle of the hairs, y upwards."""

    def at(self, canvas: Floats, field: str = "density") -> Floats:
        """The density [N] or direction [N, 2] at canvas points [N, 3]; 0 outside and behind the face."""
        x, y = canvas[:, 0] / PIXEL + WIDTH / 2, HEIGHT * 0.4 - canvas[:, 1] / PIXEL + HEIGHT * 0.4
        inside = (x >= 0) & (x < WIDTH) & (y >= 0) & (y < HEIGHT) & (canvas[:, 2] > -0.03)
        column = np.clip(x, 0, WIDTH - 1).astype(int)
        row = np.clip(y, 0, HEIGHT - 1).astype(int)
        value = getattr(self, field)[row, column]
        return np.where(inside if value.ndim == 1 else inside[:, None], value, 0)


def frontal_camera() -> Camera:
    """Almost parallel: 100 m away, PIXEL metres a pixel, the map's rows as in ``BrowMap.at``."""
    matrix = np.diag([1.0, -1.0, -1.0, 1.0])
    matrix[2, 3] = 100.0
    return Camera(100 / PIXEL, 100 / PIXEL, WIDTH / 2, HEIGHT * 0.8, WIDTH, HEIGHT, matrix)


def paint_brows(person: Person, ingredients: Ingredients) -> BrowMap:
    """The person's brow card on the average head, seen from the front."""
    base, groups = load_base(ingredients.mpfb / "3dobjs" / "base.obj")
    eyes = base.vertices[np.unique(base.quads[np.char.endswith(groups, "-eye")])].mean(0)
    folder = ingredients.makehuman / "proxies" / "eyebrows" / person.brow
    card = load_proxy(folder / f"{person.brow}.json")
    points = (card.fit(base.vertices) - eyes) / 10
    image = load_map(folder / "textures" / f"{person.brow}.png")
    seen, weights, _ = see(points, card.triangles, frontal_camera())
    hit = seen >= 0
    face = seen[hit]
    uv = (card.texture[face] * weights[hit][..., None]).sum(1)
    density = np.zeros((HEIGHT, WIDTH), np.float32)
    density[hit] = sample_map(image, uv)[:, 3]
    density = _raised(np.maximum(density, density[:, ::-1]), person.brow_lift)
    ink = np.dstack([np.ones((HEIGHT, WIDTH, 3), np.float32), density])
    soft = np.asarray(cv2.GaussianBlur(density, (0, 0), 2.2), np.float32)
    return BrowMap(density=soft, direction=strokes(ink, 7.0))


def _raised(density: NDArray[np.float32], lift: float) -> NDArray[np.float32]:
    """The brows with their inner ends ``lift`` metres higher, which takes the frown out of a card."""
    row, column = np.mgrid[:HEIGHT, :WIDTH].astype(np.float32)
    inner = np.clip((0.040 - np.abs(column - WIDTH / 2) * PIXEL) / 0.026, 0, 1)
    down = (row + lift / PIXEL * inner * inner * (3 - 2 * inner)).astype(np.float32)
    return np.asarray(cv2.remap(density, column, down, cv2.INTER_LINEAR), np.float32)


def root_brows(
    head: Head, brows: BrowMap, hairs: int, rng: np.random.Generator
) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Triangle [N], weights [N, 3] and direction [N, 3] (canvas space) of brow hairs."""
    skin = np.flatnonzero(head.parts == SKIN)
    seen, weights, _ = see(head.canvas, head.triangles[skin], frontal_camera())
    chance = np.where(seen >= 0, np.clip(brows.density - 0.12, 0, 0.6), 0).astype(float)
    cells = np.cumsum(chance.ravel())
    steps = (np.arange(hairs) + rng.random(hairs)) / hairs * cells[-1]
    cell = np.unique(np.searchsorted(cells, steps).clip(0, chance.size - 1))
    row, column = np.divmod(cell, WIDTH)
    double = brows.direction[row, column]
    angle = 0.5 * np.arctan2(double[:, 1], double[:, 0]) + rng.normal(0, 0.16, len(cell))
    direction = np.stack([np.cos(angle), np.sin(angle), np.zeros(len(cell))], 1)
    return skin[seen[row, column]], weights[row, column].astype(float), direction
