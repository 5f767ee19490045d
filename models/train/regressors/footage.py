"""Unlabelled real faces: any videos, read into relative features."""

from collections.abc import Callable, Sequence
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from ...driver.face import FaceTracker
from ...driver.features import DIMENSION, feature_vector, head_rotation, relative_rotation
from ...driver.neutral import choose_neutral
from ...mediafile import decoded, main_video, open_media, pixel_aspect_of
from ...videopicture import upright_rgb

EVERY_SECS = 0.1
"""Frames nearer than this to the last one are left out: they say the same."""


def read_footage(
    videos: Sequence[Path], progress: Callable[[int, int], None] = lambda done, total: None
) -> NDArray[np.float32]:
    """[S, D + 3] relative features and head rotations (radians) of every sampled frame with a face, each video against
    its own neutral frame.

    Raises ValueError naming a video that cannot be read or shows no face.
    """
    parts = [np.empty((0, DIMENSION + 3), np.float32)]
    for done, path in enumerate(videos):
        parts.append(_read(path))
        progress(done + 1, len(videos))
    return np.concatenate(parts)


def _read(path: Path) -> NDArray[np.float32]:
    tracker, faces, times = FaceTracker(), [], []
    try:
        with open_media(path) as container:
            stream = main_video(container)
            if stream is None or stream.codec_context is None:
                raise ValueError(f"there is no video in {path} that can be decoded; leave it out or convert it to mp4")
            pixel_aspect = pixel_aspect_of(stream)
            for frame in decoded(container, stream):
                if times and frame.time is not None and frame.time - times[-1] < EVERY_SECS:
                    continue
                face = tracker.track(upright_rgb(frame, pixel_aspect))
                if face is not None:
                    faces.append(face)
                    times.append(frame.time or 0.0)
    except (av.error.FFmpegError, OSError) as error:
        raise ValueError(f"{path} cannot be read as a video: {error}") from error
    if not faces:
        raise ValueError(f"no face was found in {path}; leave it out or give another video")
    neutral = choose_neutral(faces, times)
    rows = [
        np.concatenate(
            [feature_vector(face) - neutral.features, relative_rotation(head_rotation(face), neutral.rotation)]
        )
        for face in faces
    ]
    return np.stack(rows).astype(np.float32)
