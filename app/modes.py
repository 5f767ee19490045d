"""What single components do, as one picture (figure 3 of the paper): a row per component, from -3 to +3 sigma."""

from collections.abc import Iterable
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from ..models.gem import CLAMP_SIGMAS, MODALITIES, Gem
from ..render.arrays import Image
from ..render.camera import Camera
from ..render.compositing import over
from ..render.enginename import EngineName
from ..render.gaussians import RawGaussians
from ..render.software import SoftwareEngine
from .credentials.badge import badged
from .errors import InputError, UsageError
from .files.outputs import keep_inputs
from .files.pictures import write_png
from .performing.portrait import portrait

STEPS = 5
"""Pictures in a row: -3, -1.5, 0, 1.5 and 3 sigma."""
GROUND = (1.0, 1.0, 1.0)
FEW = 5
"""Components of each modality where nobody says how many."""
LABEL_PX = 28
"""Height of the line of text above each row."""
MOST_PIXELS = 2**27
"""50 components of each modality at 256x256 are a half of it, and as RGB it fills 400 MB."""


class Draws(Protocol):
    """Any engine of ``render``."""

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]: ...


def modes_picture(
    gem: Gem,
    components: Iterable[int] = range(3),
    modality: str = "position",
    size: tuple[int, int] = (256, 256),
    engine: Draws | None = None,
    steps: int = STEPS,
) -> Image:
    """The grid [rows * (LABEL_PX + H), steps * W, 3]: one component a row, -3 to +3 sigma from left to right.

    Args:
        gem: the avatar, at rest but for the one component.
        components: which, counted from 0.
        modality: one of ``gem.MODALITIES``.
        size: width and height of each picture, pixels.
        engine: what draws; None is the software engine.
        steps: pictures in a row; odd, so that the middle one is the mean of the component.

    Raises:
        ValueError: where the avatar has no such component.
    """
    engine = SoftwareEngine() if engine is None else engine
    camera = portrait(gem.viewing, *size)
    splats: RawGaussians | None = None
    rows: list[Image] = []
    for component in components:
        cells: list[Image] = []
        for coefficients in gem.swept(modality, component, steps):
            splats = gem.compose(coefficients, out=splats)
            cells.append(over(engine.draw(splats, camera), GROUND))
        rows += [_label(modality, component, size[0], steps), np.concatenate(cells, 1)]
    return np.concatenate(rows) if rows else np.zeros((0, steps * size[0], 3), np.uint8)


def draw_modes(path: Path, out: Path, components: int | None, size: tuple[int, int], engine: EngineName) -> None:
    """Writes a PNG of the first components of each modality of an avatar, one below the other; None draws the first
    FEW, as far as there are such. Raises CommandError."""
    from ..render.engines import open_engine
    from .performing.casting import check_components, open_avatar

    if out.suffix.lower() != ".png":
        raise UsageError(f"-o {out}: the picture is a PNG; end its name in .png")
    keep_inputs([out], [path])
    avatar = open_avatar(path)
    if not avatar.gem.components:
        raise InputError(f"{path}: has no components, so nothing of it moves; distill it of moments that differ")
    check_components(avatar, components)
    gem, components = avatar.gem, components or FEW
    rows = sum(min(components, len(gem.bases[modality])) for modality in MODALITIES)
    wide, high = STEPS * size[0], rows * (LABEL_PX + size[1])
    if wide * high > MOST_PIXELS:
        raise UsageError(f"{wide}x{high} pixels would be too large to open; ask for fewer --components or less --size")
    drawer = open_engine(engine)
    try:
        pictures = [
            modes_picture(gem, range(min(components, len(gem.bases[modality]))), modality, size, drawer)
            for modality in MODALITIES
        ]
    finally:
        drawer.close()
    write_png(badged(np.concatenate(pictures)), out)


def _label(modality: str, component: int, width: int, steps: int) -> Image:
    strip = np.full((LABEL_PX, width * steps, 3), 255, np.uint8)
    for column, sigmas in enumerate(np.linspace(-CLAMP_SIGMAS, CLAMP_SIGMAS, steps)):
        name = f"{modality} {component + 1}: " if column == 0 else ""
        text = f"{name}{sigmas:+.1f} sigma"
        place = (column * width + 6, LABEL_PX - 9)
        cv2.putText(strip, text, place, cv2.FONT_HERSHEY_SIMPLEX, min(0.5, width / 440), (60, 60, 60), 1, cv2.LINE_AA)
    return strip
