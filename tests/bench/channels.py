"""What the closed loop compares: a few channels, by the tracker's scores and, as a second opinion, by its landmarks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from gemheads.models.driver import points
from gemheads.models.driver.face import FaceObservation
from gemheads.models.driver.features import feature_vector, head_rotation, relative_rotation, score
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channel:
    """One thing a face does."""

    name: str
    floor: float
    """Standard deviation below which a driver is said not to do it: about twice what the tracker's noise gives."""
    goal: float | None = None
    """Median correlation wanted; None for second opinions."""


SCORE_CHANNELS = (
    Channel("jawOpen", 0.02, 0.9),
    Channel("mouthSmile", 0.03, 0.9),
    Channel("mouthPucker", 0.03, 0.9),
    Channel("eyeBlink", 0.03, 0.9),
    Channel("browInnerUp", 0.02, 0.8),
    Channel("browDown", 0.02, 0.8),
    Channel("gaze horizontal", 0.05, 0.8),
    Channel("gaze vertical", 0.05, 0.8),
    Channel("yaw", 1.0, 0.95),
    Channel("pitch", 1.0, 0.95),
    Channel("roll", 1.0, 0.95),
)
LANDMARK_CHANNELS = (
    Channel("lip gap", 0.01),
    Channel("mouth width", 0.01),
    Channel("lid gap", 0.004),
    Channel("brow height", 0.005),
    Channel("iris horizontal", 0.005),
    Channel("iris vertical", 0.004),
)
CHANNELS = SCORE_CHANNELS + LANDMARK_CHANNELS


@dataclass(frozen=True)
class Reading:
    """One picture of a face as numbers."""

    features: NDArray[np.float32]
    """[D] feature vector."""
    rotation: Array
    """[3] head rotation, radians."""
    landmarks: Array
    """[6] LANDMARK_CHANNELS, in units of the distance between the outer eye corners."""


def read(face: FaceObservation) -> Reading:
    """An observation as a Reading."""
    return Reading(feature_vector(face), head_rotation(face), _landmark_channels(face.landmarks_px))


def table(readings: Sequence[Reading], neutral: Reading) -> Array:
    """[frames, channels] in the order of CHANNELS, relative to the neutral; rotations in degrees."""
    relative = np.stack([reading.features for reading in readings]) - neutral.features

    def mean(*names: str) -> Array:
        return np.mean([score(relative, name) for name in names], axis=0)

    horizontal = mean("eyeLookOutLeft", "eyeLookInRight") - mean("eyeLookInLeft", "eyeLookOutRight")
    vertical = mean("eyeLookUpLeft", "eyeLookUpRight") - mean("eyeLookDownLeft", "eyeLookDownRight")
    turned = np.degrees([relative_rotation(reading.rotation, neutral.rotation) for reading in readings])
    scores = [
        mean("jawOpen"),
        mean("mouthSmileLeft", "mouthSmileRight"),
        mean("mouthPucker"),
        mean("eyeBlinkLeft", "eyeBlinkRight"),
        mean("browInnerUp"),
        mean("browDownLeft", "browDownRight"),
        horizontal,
        vertical,
        turned[:, 1],
        turned[:, 0],
        turned[:, 2],
    ]
    landmarks = np.stack([reading.landmarks for reading in readings]) - neutral.landmarks
    return np.concatenate([np.stack(scores, 1), landmarks], 1)


def correlations(driver: Array, avatar: Array) -> Array:
    """[channels] correlation over frames of two tables; NaN where the driver stays under the channel's floor."""
    moving = driver.std(0) >= [channel.floor for channel in CHANNELS]
    answer = np.full(len(CHANNELS), np.nan)
    for i in np.flatnonzero(moving):
        still = avatar[:, i].std() < 1e-9
        answer[i] = 0.0 if still else np.corrcoef(driver[:, i], avatar[:, i])[0, 1]
    return answer


def amplitudes(driver: Array, avatar: Array) -> Array:
    """[channels] how far the avatar moves over how far the driver moves (standard deviations)."""
    return avatar.std(0) / np.maximum(driver.std(0), 1e-9)


def jitters(driver: Array, avatar: Array) -> Array:
    """[channels] unrest (second differences over time) of the avatar over that of the driver, each over its range."""
    unrest = [np.sqrt((np.diff(x, 2, axis=0) ** 2).mean(0)) / np.maximum(x.std(0), 1e-9) for x in (driver, avatar)]
    return unrest[1] / np.maximum(unrest[0], 1e-9)


def _landmark_channels(px: Array) -> Array:
    """Plain distances on the landmarks of the image, without the metric mesh that drives."""
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
