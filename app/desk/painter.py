"""From a pose and the state of the desk to the picture: what the window and all outputs show."""

import threading
from dataclasses import replace

import numpy as np

from ...models.gem import Gem
from ...render.arrays import Image
from ...render.camera import Camera
from ...render.engines import Engine
from ..live import Stage, draw
from ..performing.performance import Pose
from ..performing.portrait import portrait
from ..performing.timing import Watch
from ..words import read_colour
from .compare import decibels, heat, joined
from .light import lit
from .state import DeskState

STUDIO = (0.165, 0.172, 0.188)
CURTAIN = (28, 30, 33)
KERNELS = threading.Lock()
"""One thread at a time runs compiled kernels: numba's simplest threading layer allows no more."""


def ground(name: str) -> tuple[float, float, float] | None:
    """sRGB in [0, 1] of a background; None for transparent."""
    return STUDIO if name == "studio" else read_colour(name)


def camera_of(gem: Gem, state: DeskState, width: int, height: int) -> Camera:
    """The portrait's camera, turned round the head and zoomed."""
    camera = portrait(gem.viewing, width, height, state.yaw, state.pitch)
    return replace(camera, fx=camera.fx * state.zoom, fy=camera.fy * state.zoom)


def curtain(width: int, height: int) -> Image:
    """[H, W, 3] with nothing of anybody in it."""
    return np.full((height, width, 3), CURTAIN, np.uint8)


class Painter:
    """Draws one avatar by one engine, a picture at a time."""

    def __init__(self, engine: Engine, size: tuple[int, int], watch: Watch) -> None:
        """``size``: width and height of the picture in pixels."""
        self.engine, self.size, self.watch = engine, size, watch
        self.error_db: float | None = None
        """PSNR of the last comparison."""
        self._stage: Stage | None = None
        self._whole: Stage | None = None
        self._gem: Gem | None = None
        self._key: tuple[object, ...] = ()

    def picture(self, gem: Gem, pose: Pose, state: DeskState, components: int, scale: float = 1.0) -> Image:
        """What outputs get: [H, W, 3], or [H, W, 4] with straight alpha; nothing of the avatar behind the curtain.

        ``components`` a modality, and ``scale`` of the size, as far as the machine allows.
        """
        if state.curtain:
            return curtain(*self.size)
        with KERNELS:
            return draw(self._staged(gem, state, components, scale), pose)

    def comparison(self, pose: Pose, state: DeskState, used: Image) -> Image:
        """What the window shows while A and B are compared, after ``picture`` drew B, which is ``used``."""
        assert self._whole is not None
        with KERNELS:
            whole = draw(self._whole, pose)
        self.error_db = decibels(whole, used)
        other = heat(whole, used) if state.error_map else used
        # the preview is mirrored as a whole: the split is where the person sees it
        return joined(other, whole, 1 - state.split) if state.mirror else joined(whole, other, state.split)

    def _staged(self, gem: Gem, state: DeskState, components: int, scale: float) -> Stage:
        """The stage of the frame before, unless something on it changed."""
        width, height = (max(16, round(side * scale / 2) * 2) for side in self.size)
        key = (components, width, height, state.yaw, state.pitch, state.zoom, state.background)
        key = (*key, state.exposure, state.warmth)
        if self._stage is None or gem is not self._gem or key != self._key:
            camera, background = camera_of(gem, state, width, height), ground(state.background)
            self._whole = Stage(_lit(gem, state), self.engine, camera, background, self.watch)
            self._stage = replace(self._whole, components=min(components, gem.components))
            self._gem, self._key = gem, key
        return self._stage


def _lit(gem: Gem, state: DeskState) -> Gem:
    colors = lit(gem.colors, state.exposure, state.warmth)
    return gem if colors is gem.colors else replace(gem, colors=colors)
