"""Where a fit begins: the face tracker looks at the picture and at the avatar, and compares."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...models.driver.answer import Express
from ...models.driver.face import FaceObservation, FaceTracker
from ...models.driver.features import feature_vector, head_rotation, relative_rotation, rotation_in_camera
from ...models.gem import Gem
from ...render.arrays import Floats32
from ...render.camera import Camera
from ...render.compositing import over
from ...render.rotations import matrix_from_wxyz, wxyz_from_rotvec
from ...render.software import SoftwareEngine

_UPRIGHT = np.diag([1.0, -1.0, -1.0])
"""The tracker's axes (y up, looking along -z) in those of the camera (y down, along +z)."""
FACE_FORWARD = 0.3
"""The landmarks' middle lies so much of the head's height before the head's."""


@dataclass(frozen=True)
class Guess:
    """An expression and a pose."""

    coefficients: Floats32
    """[coefficients]."""
    turn: Floats32
    """[3] radians."""
    move: Floats32
    """[3] metres."""


class Guesser:
    """Compares faces with that of the avatar at rest, seen by the same camera."""

    def __init__(
        self, gem: Gem, camera: Camera, background: tuple[float, float, float], express: Express | None
    ) -> None:
        """``express``: what turns relative features into this avatar's coefficients; None leaves it at rest."""
        self._gem, self._camera, self._express = gem, camera, express
        self._tracker = FaceTracker()
        image = SoftwareEngine().draw(gem.compose(gem.rest_coefficients), camera)
        self._rest = self._tracker.track(over(image, background))

    def guess(self, rgb: NDArray[np.uint8]) -> Guess | None:
        """Of a picture [H, W, 3] of the camera's size; None where no face is found in it, or none in the avatar's."""
        self._tracker.reset()
        face = self._tracker.track(rgb)
        rest = self._rest
        if face is None or rest is None:
            return None
        rotations = head_rotation(face), head_rotation(rest)
        coefficients = self._gem.rest_coefficients
        if self._express is not None:
            relative = feature_vector(face) - feature_vector(rest)
            coefficients = self._gem.clamped(self._express(relative, relative_rotation(*rotations)).coefficients)
        turn = (_UPRIGHT @ self._camera.world_to_camera[:3, :3]).T @ rotation_in_camera(*rotations)
        return Guess(coefficients, turn.astype(np.float32), self._move(face, rest, turn).astype(np.float32))

    def _move(self, face: FaceObservation, rest: FaceObservation, turn: NDArray[np.float64]) -> NDArray[np.float64]:
        """What is left of the way the face went when the turn about the neck is taken off."""
        viewing = self._gem.viewing
        x, y, z = viewing.target
        surface = np.array([x, y, z + FACE_FORWARD * viewing.head_height, 1.0])
        depth = float(self._camera.world_to_camera[2] @ surface)
        before = self._place(rest, depth)
        after = self._place(face, depth * float(face.head_pose[2, 3] / rest.head_pose[2, 3]))
        pivot = self._gem.neck_pivot.astype(np.float64)
        return after - (matrix_from_wxyz(wxyz_from_rotvec(turn)) @ (before - pivot) + pivot)

    def _place(self, face: FaceObservation, depth: float) -> NDArray[np.float64]:
        """The middle of the landmarks in the world, at this depth."""
        camera, (x, y) = self._camera, face.landmarks_px[:468, :2].mean(0)
        seen = depth * np.array([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0])
        return camera.world_to_camera[:3, :3].T @ (seen - camera.world_to_camera[:3, 3])
