"""One picture of a face as the numbers that are compared, and many of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64
from ..driver import points
from ..driver.face import FaceObservation
from ..driver.features import feature_vector, head_rotation

LANDMARKS = ("lip gap", "mouth width", "lid gap", "brow height", "iris horizontal", "iris vertical")
"""Plain distances: a second opinion that goes neither through the scores nor through the metric mesh that drives."""


@dataclass(frozen=True)
class Reading:
    """One picture."""

    features: NDArray[np.float32]
    """[D] feature vector."""
    rotation: Floats64
    """[3] head rotation, radians."""
    landmarks: Floats64
    """[6] LANDMARKS, in units of the distance between the outer eye corners."""
    embedding: NDArray[np.float32]
    """[512] of the tracker's landmark network."""


@dataclass(frozen=True)
class Readings:
    """F pictures."""

    features: NDArray[np.float32]
    """[F, D]"""
    rotations: Floats64
    """[F, 3]"""
    landmarks: Floats64
    """[F, 6]"""
    embeddings: NDArray[np.float32]
    """[F, 512]"""

    def __len__(self) -> int:
        return len(self.features)

    def __getitem__(self, index: int) -> Reading:
        return Reading(self.features[index], self.rotations[index], self.landmarks[index], self.embeddings[index])

    def only(self, chosen: NDArray[np.integer] | NDArray[np.bool_]) -> "Readings":
        """Those of some pictures, by their places or by a mask."""
        return Readings(self.features[chosen], self.rotations[chosen], self.landmarks[chosen], self.embeddings[chosen])


def read(face: FaceObservation) -> Reading:
    """An observation as a Reading."""
    return Reading(feature_vector(face), head_rotation(face), landmark_distances(face.landmarks_px), face.embedding)


def stacked(readings: Sequence[Reading]) -> Readings:
    """Many as one. Raises ValueError for none at all."""
    return Readings(
        np.stack([reading.features for reading in readings]),
        np.stack([reading.rotation for reading in readings]),
        np.stack([reading.landmarks for reading in readings]),
        np.stack([reading.embedding for reading in readings]),
    )


def landmark_distances(px: Floats64) -> Floats64:
    """LANDMARKS [6] of a picture's landmarks [478, 3]."""
    sides = (
        (points.RIGHT_EYE_OUTER, points.RIGHT_EYE_INNER, points.RIGHT_IRIS, (159, 145), points.RIGHT_BROW),
        (points.LEFT_EYE_INNER, points.LEFT_EYE_OUTER, points.LEFT_IRIS, (386, 374), points.LEFT_BROW),
    )
    unit = np.linalg.norm(px[points.LEFT_EYE_OUTER] - px[points.RIGHT_EYE_OUTER])
    across = (px[points.LEFT_EYE_OUTER] - px[points.RIGHT_EYE_OUTER]) / unit
    eyes = []
    for first, second, iris, (upper, lower), brow in sides:
        middle = (px[first] + px[second]) / 2
        down = px[lower] + px[upper] - 2 * px[brow[2]]
        axis = down - across * (down @ across)
        axis /= np.linalg.norm(axis)
        gaze = px[iris] - middle
        eyes.append(
            [
                np.linalg.norm(px[upper] - px[lower]),
                (middle - px[list(brow)].mean(0)) @ axis,
                gaze @ across,
                -gaze @ axis,
            ]
        )
    lid, height, horizontal, vertical = np.mean(eyes, axis=0)
    lips, width = np.linalg.norm(px[13] - px[14]), np.linalg.norm(px[61] - px[291])
    return np.array([lips, width, lid, height, horizontal, vertical]) / unit
