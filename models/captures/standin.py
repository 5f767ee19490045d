"""An avatar where the person of a capture was: the same head pose, the same camera, the same ground."""

import numpy as np
from numpy.typing import NDArray

from ...render.gaussians import RawGaussians
from ...render.software import SoftwareEngine
from ..posing import pose_head
from .layout import Shot
from .reader import Capture


class StandIn:
    """Draws canonical splats as a capture's cameras would see them. One per thread."""

    def __init__(self, capture: Capture) -> None:
        self._capture = capture
        self._engine = SoftwareEngine()

    def draw(
        self,
        raw: RawGaussians,
        neck_weights: NDArray[np.float32],
        pivot: NDArray[np.float32],
        shot: Shot,
        pose: tuple[NDArray[np.float32], NDArray[np.float32]] | None = None,
    ) -> NDArray[np.float32]:
        """[H, W, 3] sRGB in [0, 1] of an expression.

        Args:
            raw: canonical splats.
            neck_weights: [N] share of the head's pose.
            pivot: [3] the point the head turns about, metres.
            shot: where from, and when.
            pose: turn [3] (axis times angle, radians) and move [3] (metres) of the head; None: as it was tracked then.
        """
        tracked = self._capture.tracked(shot.timestep)
        turn, move = (tracked.rotation, tracked.translation) if pose is None else pose
        posed = pose_head(raw, neck_weights, pivot, turn, move)
        image = self._engine.draw(posed, shot.camera)
        ground = np.array(self._capture.ground(shot), np.float32)
        return np.clip(image[..., :3] + (1 - image[..., 3:]) * ground, 0, 1).astype(np.float32)

    def truth(self, shot: Shot) -> NDArray[np.float32]:
        """[H, W, 3] the picture that was taken, over its background."""
        rgba = self._capture.read(shot).astype(np.float32) / 255
        ground = np.array(self._capture.ground(shot), np.float32)
        return (rgba[..., :3] * rgba[..., 3:] + ground * (1 - rgba[..., 3:])).astype(np.float32)
