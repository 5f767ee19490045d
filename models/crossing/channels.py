"""What the closed loop compares: a few channels, by the tracker's scores and, as a second opinion, by its landmarks."""

from dataclasses import dataclass

import numpy as np

from ...render.arrays import Floats64
from ..driver.features import relative_rotation, rotation_in_camera, score
from .reading import LANDMARKS, Reading, Readings


@dataclass(frozen=True)
class Channel:
    """One thing a face does."""

    name: str
    floor: float
    """Standard deviation below which a driver is said not to do it: about twice what the tracker's noise gives."""
    goal: float | None = None
    """Median correlation wanted; None for second opinions."""


SCORE_CHANNELS = (
    Channel("jawOpen", 0.02, 0.97),
    Channel("mouthSmile", 0.03, 0.97),
    Channel("mouthPucker", 0.03, 0.95),
    Channel("eyeBlink", 0.03, 0.97),
    Channel("browInnerUp", 0.02, 0.9),
    Channel("browDown", 0.02, 0.9),
    Channel("gaze horizontal", 0.05, 0.9),
    Channel("gaze vertical", 0.05, 0.9),
    Channel("yaw", 1.0, 0.985),
    Channel("pitch", 1.0, 0.985),
    Channel("roll", 1.0, 0.985),
)
LANDMARK_CHANNELS = tuple(
    Channel(name, floor) for name, floor in zip(LANDMARKS, (0.01, 0.01, 0.004, 0.005, 0.005, 0.004), strict=True)
)
CHANNELS = SCORE_CHANNELS + LANDMARK_CHANNELS
STILL = 1e-9
"""Standard deviation of what does not move at all."""


def table(readings: Readings, neutral: Reading, portrait: bool = False) -> Floats64:
    """[F, channels] in the order of CHANNELS, relative to the neutral; rotations in degrees, of a ``portrait`` of an
    avatar about the axes of its camera, which is known."""
    rotation_of = rotation_in_camera if portrait else relative_rotation
    relative = readings.features - neutral.features

    def mean(*names: str) -> Floats64:
        return np.mean([score(relative, name) for name in names], axis=0)

    horizontal = mean("eyeLookOutLeft", "eyeLookInRight") - mean("eyeLookInLeft", "eyeLookOutRight")
    vertical = mean("eyeLookUpLeft", "eyeLookUpRight") - mean("eyeLookDownLeft", "eyeLookDownRight")
    turned = np.degrees([rotation_of(rotation, neutral.rotation) for rotation in readings.rotations])
    turned = turned.reshape(-1, 3)  # of no pictures at all, too
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
    return np.concatenate([np.stack(scores, 1), readings.landmarks - neutral.landmarks], 1)


def moving(driver: Floats64) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """[channels] whether a driver's table shows that he does it at all."""
    return driver.std(0) >= [channel.floor for channel in CHANNELS]


def correlations(driver: Floats64, avatar: Floats64) -> Floats64:
    """[channels] correlation over frames of two tables; NaN where the driver stays under the channel's floor."""
    answer = np.full(len(CHANNELS), np.nan)
    for i in np.flatnonzero(moving(driver)):
        still = avatar[:, i].std() < STILL
        answer[i] = 0.0 if still else np.corrcoef(driver[:, i], avatar[:, i])[0, 1]
    return answer


def amplitudes(driver: Floats64, avatar: Floats64) -> Floats64:
    """[channels] how far the avatar moves over how far the driver moves (standard deviations)."""
    return avatar.std(0) / np.maximum(driver.std(0), STILL)


def unrests(driver: Floats64, avatar: Floats64) -> Floats64:
    """[channels] unrest (second differences over time) of the avatar over that of the driver, each over its range."""
    unrest = [np.sqrt((np.diff(x, 2, axis=0) ** 2).mean(0)) / np.maximum(x.std(0), STILL) for x in (driver, avatar)]
    return unrest[1] / np.maximum(unrest[0], STILL)
