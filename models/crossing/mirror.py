"""The avatar in front of the tracker: coefficients and head rotation in, what the tracker reads off its picture out."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Image
from ...render.camera import orbit
from ...render.compositing import over
from ...render.software import SoftwareEngine
from ..driver.answer import Answer
from ..driver.face import FaceTracker, looked
from ..gem import Gem
from ..posing import pose_head
from .reading import Reading, read

LOOKS = 4
"""At a still picture, until the tracker's region has settled."""
HEAD_SHARE = 0.65
"""Of the picture's height: the portrait that people get."""
FOV_DEG = 20.0
_BACKGROUND = (0.75, 0.75, 0.75)


class UnseenAvatar(RuntimeError):
    """The tracker sees no face in an avatar's neutral picture, so nothing can be read off it."""


class Mirror:
    """One avatar, drawn as a portrait by the software engine, which gives the same picture on every machine."""

    def __init__(self, gem: Gem, size: int, fov_deg: float = FOV_DEG) -> None:
        """``size`` is the side of the picture in pixels, ``fov_deg`` the camera's field of view: the wider, the nearer
        is the head."""
        viewing = gem.viewing
        distance = viewing.head_height / HEAD_SHARE / (2 * np.tan(np.radians(fov_deg) / 2))
        self.gem = gem
        self._camera = orbit(viewing.target, distance, 0, 0, fov_deg, size, size)
        self._engine = SoftwareEngine()
        self._tracker = FaceTracker()

    def draw(
        self, coefficients: NDArray[np.floating], rotation: NDArray[np.floating], components: int | None = None
    ) -> Image:
        """The picture [size, size, 3] of the avatar with its head turned by ``rotation`` [3]."""
        gem = self.gem
        raw = gem.compose(np.asarray(coefficients, np.float32), components=components)
        raw = pose_head(raw, gem.neck_weights, gem.neck_pivot, np.asarray(rotation), np.zeros(3))
        return over(self._engine.draw(raw, self._camera), _BACKGROUND)

    def follow(self, answer: Answer, components: int | None = None) -> Image:
        """The picture of the avatar that does what was read on a driver."""
        return self.draw(answer.coefficients, answer.turn, components)

    def read(self, picture: Image, looks: int = 1) -> Reading | None:
        """What the tracker reads after so many looks; None when it sees no face."""
        face = looked(self._tracker, picture, looks)
        return None if face is None else read(face)

    def neutral(self, components: int | None = None) -> Reading:
        """The avatar at rest, looking straight ahead. Raises UnseenAvatar when the tracker does not see it."""
        picture = self.draw(self.gem.rest_coefficients, np.zeros(3), components)
        self.restart()
        reading = self.read(picture, LOOKS)
        if reading is None:
            raise UnseenAvatar(f"the tracker sees no face in the neutral picture of avatar {self.gem.name!r}")
        return reading

    def restart(self) -> None:
        """Forget the last picture."""
        self._tracker.reset()
