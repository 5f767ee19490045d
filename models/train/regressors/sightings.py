"""What the face tracker reads off a capture's own pictures, as a driver's camera would have shown them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...captures.layout import CaptureError, Shot
from ...captures.reader import Capture
from ...driver.face import FaceTracker
from ...driver.features import DIMENSION, feature_vector, head_rotation, relative_rotation

FRONTAL = 5
"""Cameras, as in section 3.2 of the paper."""
NEUTRALS = 3
"""Moments nearest to the template whose median is the neutral: one alone carries its noise into all others."""


@dataclass(frozen=True)
class Neutral:
    """The person at rest, seen from the front."""

    features: NDArray[np.float32]
    """[D]"""
    rotation: NDArray[np.float64]
    """[3] of the head before that camera, radians."""


@dataclass(frozen=True)
class Sightings:
    """S pictures in which the tracker saw the face."""

    shots: tuple[Shot, ...]
    features: NDArray[np.float32]
    """[S, D] relative to the neutral."""
    rotations: NDArray[np.float32]
    """[S, 3] relative to the neutral's camera, radians: another camera shows a head that is turned."""
    unseen: int
    """Pictures without a face."""

    def __len__(self) -> int:
        return len(self.shots)


def frontal_cameras(capture: Capture, split: str, count: int = FRONTAL) -> tuple[int, ...]:
    """Of the cameras that took a split's pictures those that look the person in the face, the most frontal one first.
    The one that is held out of training is often the most frontal of all, and in the test split."""
    places = {shot.camera_index: shot.camera.center for shot in capture.shots(split)}
    target = np.asarray(capture.viewing().target)

    def turned(camera: int) -> float:
        offset = places[camera] - target
        return float(np.arccos(offset[2] / np.linalg.norm(offset)))

    return tuple(sorted(places, key=turned)[:count])


def neutral_of(capture: Capture) -> Neutral:
    """The neutral among the training pictures of the most frontal camera: the moments whose mesh is nearest to the
    template. Raises CaptureError where the tracker sees a face in none of them."""
    (front,) = frontal_cameras(capture, "train", 1)
    shots = {shot.timestep: shot for shot in capture.train if shot.camera_index == front}
    at_rest = capture.template.vertices

    def distance(timestep: int) -> float:
        return float(np.square(capture.tracked(timestep).vertices - at_rest).sum(1).mean())

    tracker, found = FaceTracker(), []
    for timestep in sorted(shots, key=distance):
        tracker.reset()
        face = tracker.track(capture.over_background(shots[timestep]))
        if face is not None:
            found.append((feature_vector(face), head_rotation(face)))
        if len(found) == NEUTRALS:
            break
    if not found:
        cure = "pictures of at least 100 pixels with the face in front are needed"
        raise CaptureError(capture.folder, f"the face tracker sees no face in camera {front}", cure)
    return Neutral(np.median([features for features, _ in found], 0).astype(np.float32), found[0][1])


def see(
    capture: Capture,
    shots: Sequence[Shot],
    neutral: Neutral,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Sightings:
    """Reads shots with the face tracker, camera by camera in the order of time.

    Raises CaptureError where the capture changed since it was opened.
    """
    kept: list[Shot] = []
    features, rotations = [np.empty((0, DIMENSION), np.float32)], [np.empty((0, 3), np.float32)]
    tracker, camera = FaceTracker(), -1
    for done, shot in enumerate(sorted(shots, key=lambda s: (s.camera_index, s.timestep)), 1):
        if shot.camera_index != camera:
            tracker.reset()
            camera = shot.camera_index
        face = tracker.track(capture.over_background(shot))
        if face is not None:
            kept.append(shot)
            features.append((feature_vector(face) - neutral.features)[None])
            rotations.append(relative_rotation(head_rotation(face), neutral.rotation)[None].astype(np.float32))
        progress(done, len(shots))
    return Sightings(tuple(kept), np.concatenate(features), np.concatenate(rotations), len(shots) - len(kept))
