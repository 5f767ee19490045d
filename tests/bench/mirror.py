"""The avatar in front of the tracker: coefficients and head rotation in, what the tracker reads off its picture out."""

import cv2
import numpy as np
from channels import Reading, read
from gemheads.models.driver.face import FaceTracker
from gemheads.models.gem import Gem
from gemheads.models.posing import pose_head
from gemheads.render.camera import orbit
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine
from numpy.typing import NDArray

_HEAD_SHARE = 0.65
"""Of the picture's height: the portrait that people get."""
_FOV_DEG = 20.0
_BACKGROUND = (0.75, 0.75, 0.75)


class Mirror:
    """One avatar, drawn as a portrait."""

    def __init__(self, gem: Gem, size: int) -> None:
        """``size`` is the side of the picture in pixels."""
        viewing = gem.viewing
        distance = viewing.head_height / _HEAD_SHARE / (2 * np.tan(np.radians(_FOV_DEG) / 2))
        self._camera = orbit(viewing.target, distance, 0, 0, _FOV_DEG, size, size)
        self._gem = gem
        self._engine = SoftwareEngine()
        self._tracker = FaceTracker()

    def draw(self, coefficients: NDArray[np.float32], rotation: NDArray[np.floating], components: int | None = None):
        """The picture [size, size, 3] of the avatar with its head turned by ``rotation`` [3]."""
        raw = self._gem.compose(coefficients, components=components)
        raw = pose_head(raw, self._gem.neck_weights, self._gem.neck_pivot, np.asarray(rotation), np.zeros(3))
        return over(self._engine.draw(raw, self._camera), _BACKGROUND)

    def read(self, picture: NDArray[np.uint8]) -> Reading | None:
        """What the tracker reads; None when it sees no face."""
        face = self._tracker.track(picture)
        return None if face is None else read(face)

    def neutral(self, components: int | None = None) -> Reading:
        """The avatar at rest, looking straight ahead. Raises RuntimeError when the tracker does not see it."""
        picture = self.draw(self._gem.rest_coefficients, np.zeros(3), components)
        self.restart()
        for _ in range(4):  # the region settles in a few looks
            reading = self.read(picture)
        if reading is None:
            raise RuntimeError(f"the tracker sees no face in the neutral picture of avatar {self._gem.name!r}")
        return reading

    def restart(self) -> None:
        """Forget the last picture."""
        self._tracker.reset()


def small(picture: NDArray[np.uint8], side: int) -> NDArray[np.uint8]:
    """A square picture made smaller for a film strip."""
    return cv2.resize(picture, (side, side), interpolation=cv2.INTER_AREA)
