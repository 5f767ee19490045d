"""What a picture shows of the driver, in numbers; and which of several faces is meant."""

import numpy as np
from numpy.typing import NDArray

from ...models.driver.detector import overlap
from ...models.driver.face import SAME_FACE, Box, FaceObservation
from ...models.driver.features import feature_vector, head_rotation
from ..files.frames import LUMA
from ..performing.shots import Observed
from .following import Tracker


def lock_next(tracker: Tracker, rgb: NDArray[np.uint8], box: Box | None) -> bool:
    """Lock on the face to the right of the followed one, from the last back to the first; False without another."""
    faces = sorted(tracker.detect(rgb), key=lambda face: face.box_px[0])
    others = [face for face in faces if box is None or overlap(face.box_px, box) < SAME_FACE]
    if not others:
        return False
    tracker.lock(next((face for face in others if box is not None and face.box_px[0] > box[0]), others[0]))
    return True


def observe(face: FaceObservation, rgb: NDArray[np.uint8], faces: int) -> Observed:
    """A followed face of a picture [H, W, 3] that shows so many faces."""
    left, top, right, bottom = (max(0, round(side)) for side in face.box_px)
    inside = rgb[top:bottom:8, left:right:8]
    surround = float(np.dot(rgb[::16, ::16].reshape(-1, 3).mean(0), LUMA))
    return Observed(
        features=feature_vector(face),
        rotation=head_rotation(face),
        box_px=face.box_px,
        picture_size=face.image_size,
        luma=float(np.dot(inside.reshape(-1, 3).mean(0), LUMA)) if inside.size else surround,
        surround=surround,
        sharpness=face.sharpness,
        presence=face.presence,
        faces=faces,
    )


def sketch_of(face: FaceObservation | None) -> NDArray[np.float32] | None:
    """[478, 2] the landmarks in [0, 1] of the picture; None without a face."""
    return None if face is None else (face.landmarks_px[:, :2] / face.image_size).astype(np.float32)
