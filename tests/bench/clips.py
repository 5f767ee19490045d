"""Driving clips as readings, tracked once and kept in a cache folder."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import av
import cv2
import numpy as np
from channels import Reading, read
from gemheads.models.driver.face import FaceObservation, FaceTracker
from gemheads.models.driver.features import FEATURE_VERSION
from gemheads.models.driver.neutral import choose_neutral
from numpy.typing import NDArray

SHOTS = 10
"""Pictures kept of each clip for the film strip."""
SHOT_SIDE = 192
_AROUND = (191, 191, 191)


@dataclass(frozen=True)
class Clip:
    """One driver."""

    name: str
    readings: list[Reading]
    """The frames in which a face was seen."""
    neutral: Reading
    reason: str
    """Why this neutral."""
    shots: NDArray[np.uint8]
    """[SHOTS, SHOT_SIDE, SHOT_SIDE, 3] the face at frames spread over the clip."""
    shot_frames: list[int]
    """Which readings they belong to."""
    losses: int
    """Frames without a face."""


def load_clip(path: Path, every: int, seconds: float, cache: Path) -> Clip:
    """Tracks each ``every``-th frame of a video's first ``seconds``, or reads what an earlier run found."""
    stat = path.stat()
    key = f"{path.resolve()} {stat.st_size} {stat.st_mtime_ns} {every} {seconds} {FEATURE_VERSION} {SHOTS}"
    file = cache / f"{path.stem}-{hashlib.sha256(key.encode()).hexdigest()[:12]}.npz"
    if not file.exists():
        cache.mkdir(parents=True, exist_ok=True)
        np.savez(file, **_tracked(path, every, seconds))
    with np.load(file) as data:
        rows = zip(data["features"], data["rotations"], data["landmarks"], strict=True)
        readings = [Reading(*row) for row in rows]
        neutral = Reading(data["neutral_features"], data["neutral_rotation"], data["neutral_landmarks"])
        shot_frames = [int(i) for i in data["shot_frames"]]
        return Clip(path.stem, readings, neutral, str(data["reason"]), data["shots"], shot_frames, int(data["losses"]))


def _tracked(path: Path, every: int, seconds: float) -> dict[str, NDArray[np.generic]]:
    tracker = FaceTracker()
    faces: list[FaceObservation] = []
    times: list[float] = []
    pictures: list[NDArray[np.uint8]] = []
    losses = 0
    with av.open(path) as video:
        for i, frame in enumerate(video.decode(video=0)):
            if i % every:
                continue
            if (frame.time or 0.0) > seconds:
                break
            picture = frame.to_ndarray(format="rgb24")
            face = tracker.track(picture)
            if face is None:
                losses += 1
                continue
            faces.append(face)
            times.append(frame.time or 0.0)
            pictures.append(_shot(picture, face))
    choice = choose_neutral(faces, times)
    readings = [read(face) for face in faces]
    shot_frames = np.linspace(0, len(faces) - 1, SHOTS + 2).round().astype(int)[1:-1]
    return {
        "features": np.stack([reading.features for reading in readings]),
        "rotations": np.stack([reading.rotation for reading in readings]),
        "landmarks": np.stack([reading.landmarks for reading in readings]),
        "neutral_features": choice.features,
        "neutral_rotation": choice.rotation,
        "neutral_landmarks": readings[choice.index].landmarks,
        "reason": np.array(choice.reason),
        "shots": np.stack([pictures[i] for i in shot_frames]),
        "shot_frames": shot_frames,
        "losses": np.array(losses),
    }


def _shot(picture: NDArray[np.uint8], face: FaceObservation) -> NDArray[np.uint8]:
    """The face with its surroundings, upright in the image, as a small square."""
    left, top, right, bottom = face.box_px
    scale = SHOT_SIDE / (1.7 * max(right - left, bottom - top))
    matrix = np.array(
        [
            [scale, 0, SHOT_SIDE / 2 - scale * (left + right) / 2],
            [0, scale, SHOT_SIDE / 2 - scale * (top + bottom) / 2],
        ]
    )
    return cv2.warpAffine(picture, matrix, (SHOT_SIDE, SHOT_SIDE), flags=cv2.INTER_AREA, borderValue=_AROUND)
