"""Pictures of a moment."""

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.camera import Camera
from .lamps import ROOM
from .moment import Moment, Stage
from .raster import projected, rasterize
from .shading import Light, Maps, Samples, Surface, shade

FINER = 2
"""Samples along a pixel."""
SHARPEST = 0.7
"""Texels a sample that the eye does not miss: beyond it a smaller map is taken."""


class Painter:
    """Draws moments of one stage."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        subject = stage.subject
        self._maps = [(subject.albedo, subject.detail)]
        while len(self._maps) < 4:
            self._maps.append(tuple(_halved(image) for image in self._maps[-1]))  # pyright: ignore[reportArgumentType]

    def draw(self, moment: Moment, camera: Camera) -> NDArray[np.float32]:
        """sRGB-encoded premultiplied RGBA [H, W, 4] in 0..1."""
        subject, stage = self.stage.subject, self.stage
        height, width = camera.height * FINER, camera.width * FINER
        seen = np.empty((height, width), np.int32)
        weights = np.empty((height, width, 2), np.float32)
        depth = np.empty((height, width), np.float32)
        clear = np.empty((height, width), np.float32)
        points = projected(moment.vertices, camera, FINER)
        rasterize(
            points,
            subject.template.triangles,
            subject.card_triangles,
            subject.card_uv,
            subject.card_is_lash,
            subject.hair,
            subject.lash,
            seen,
            weights,
            depth,
            clear,
        )
        albedo, detail = self._maps[self._level(camera)]
        image = np.empty((height, width, 4), np.float32)
        surface = Surface(
            subject.triangles,
            stage.parts,
            stage.uv,
            moment.slopes,
            moment.vertices,
            moment.normals,
            moment.folds[:, None],
            moment.eyes,
            moment.strands,
        )
        lamps = stage.lighting
        light = Light(moment.light, moment.mean, moment.shares, lamps.lobes, lamps.bulbs, np.array(ROOM, np.float32))
        maps = Maps(albedo, detail, subject.hair, stage.hair_color)
        shade(Samples(seen, weights, clear), surface, light, maps, camera.center.astype(np.float32), image)
        image[..., :3] = _encoded(image[..., :3])
        small = cv2.resize(image, (camera.width, camera.height), interpolation=cv2.INTER_AREA)
        return np.asarray(small, np.float32)

    def _level(self, camera: Camera) -> int:
        """Which of the smaller maps has about as many texels across the face as the picture has samples."""
        face = np.asarray(self.stage.subject.viewing.target)
        distance = float(np.linalg.norm(camera.center - face))
        samples_a_metre = camera.fy * FINER / distance
        texels_a_metre = 0.45 * len(self._maps[0][0]) / 0.15  # 45 % of the map are the face, 15 cm of it
        level = np.floor(np.log2(max(texels_a_metre * SHARPEST / samples_a_metre, 1.0)) + 0.5)
        return int(min(level, len(self._maps) - 1))


def _halved(image: Floats) -> NDArray[np.float32]:
    size = image.shape[1] // 2, image.shape[0] // 2
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.float32)


def _encoded(light: Floats) -> NDArray[np.float32]:
    """Linear light to sRGB, by a table."""
    index = np.clip(light * 4095 + 0.5, 0, 4095).astype(np.uint16)
    return _table()[index]


@lru_cache(maxsize=1)
def _table() -> NDArray[np.float32]:
    light = np.arange(4096) / 4095
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055).astype(np.float32)
