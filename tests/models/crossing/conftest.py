"""A driver who is painted and an avatar that paints what it is told: the loop without networks and without splats."""

from collections.abc import Iterator

import numpy as np
import pytest
from gemheads.models.crossing import clip as clips
from gemheads.models.crossing import still
from gemheads.models.crossing.clip import Clip, track_clip
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.answer import Answer, Express
from gemheads.models.driver.features import score
from gemheads.models.gem import Gem
from gemheads.render.arrays import Image
from numpy.typing import NDArray
from pixelface import PixelTracker, painted

RATE = 25


class PaintedMirror(Mirror):
    """An avatar of as many coefficients as its file has, of which the first is the jaw and the second the smile."""

    def __init__(self, gem: Gem) -> None:
        self.gem = gem
        self._tracker = PixelTracker()
        self.hidden: set[int] = set()
        self.drawn = 0

    def draw(
        self, coefficients: NDArray[np.floating], rotation: NDArray[np.floating], components: int | None = None
    ) -> Image:
        """Black where ``hidden`` names the picture's number."""
        self.drawn += 1
        picture = painted(coefficients[0], coefficients[1], rotation[1])
        return np.zeros_like(picture) if self.drawn - 1 in self.hidden else picture


@pytest.fixture
def mirror(tiny_gem: Gem) -> PaintedMirror:
    return PaintedMirror(tiny_gem)


@pytest.fixture(autouse=True)
def painted_faces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Everybody's tracker reads paint."""
    for module in (clips, still):
        monkeypatch.setattr(module, "FaceTracker", PixelTracker)


@pytest.fixture
def express(tiny_gem: Gem) -> Express:
    """A driving that copies jaw, smile and turn."""

    def copied(relative: NDArray[np.floating], rotation: NDArray[np.floating]) -> Answer:
        coefficients = np.zeros(tiny_gem.coefficient_count, np.float32)
        coefficients[0], coefficients[1] = score(relative, "jawOpen"), score(relative, "mouthSmileLeft")
        return Answer(coefficients, rotation)

    return copied


def performed(frames: int = 50) -> Iterator[tuple[Image, float]]:
    """Talks, smiles slowly and turns; at rest in the beginning."""
    for frame in range(frames):
        t = max(0.0, (frame - 6) / (frames - 6))
        yield painted(0.5 * abs(np.sin(12 * t)), 0.8 * t, np.radians(10 * np.sin(6 * t))), frame / RATE


@pytest.fixture
def clip(painted_faces: None) -> Clip:
    return track_clip(performed(), 1, 60.0)
