"""Analysis by synthesis on a capture: each moment from all of its cameras at once, one moment after the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ....render.camera import Camera
from ...captures.layout import Shot
from ...captures.reader import Capture
from ...gem import Gem
from .fit import Descent, Effort, Fit, HeadPose, Start, fit

ALONE = Effort((Descent(64, 6, pose_only=True), Descent(None, 33)))
"""A moment of which nothing is known but the head's place ..."""
FOLLOWING = Effort((Descent(None, 17),))
"""... and one that follows another: captures show moments far apart, so it takes longer than a video's next frame."""
LARGEST_SIDE = 512
"""Pictures are brought down to this before they are fitted: more pixels tell little more, and cost."""
NEIGHBOURS = 3
"""A moment at most so many steps after the one before begins where that ended."""
LOST_DB = 6.0
"""One that comes out so much worse than the one before is begun anew."""


@dataclass(frozen=True)
class FittedMoment:
    """One moment of a capture."""

    timestep: int
    shots: tuple[Shot, ...]
    """The pictures it was found in ..."""
    pictures: tuple[NDArray[np.uint8], ...]
    """... and their pixels, [H, W, 3] over the capture's background, as large as they were fitted."""
    fit: Fit


def fit_moments(gem: Gem, capture: Capture, shots: Sequence[Shot], effort: Effort = ALONE) -> Iterator[FittedMoment]:
    """Expression and pose of every moment that the shots show, in order of time.

    The head's pose begins where the capture's tracker saw it, the expression where the moment before ended.

    Args:
        gem: an avatar of this person, whose canonical space is the template's.
        capture: where the shots are from.
        shots: of one split, or some of its cameras.
        effort: for the first moment, and where the one before does not help; FOLLOWING for the others.

    Raises CaptureError where the capture changed since it was opened.
    """
    moments: dict[int, list[Shot]] = {}
    for shot in shots:
        moments.setdefault(shot.timestep, []).append(shot)
    before: tuple[int, Fit] | None = None
    for timestep in sorted(moments):
        views = tuple(sorted(moments[timestep], key=lambda shot: shot.camera_index))
        tracked = capture.tracked(timestep)
        pose = HeadPose(tracked.rotation, tracked.translation)
        pictures, cameras = zip(*(_view(capture, shot) for shot in views), strict=True)
        answer, ground = None, capture.ground(views[0])  # one split has one
        if before is not None and timestep - before[0] <= NEIGHBOURS:
            start = Start(before[1].coefficients, pose, before[1].memory)
            answer = fit(gem, pictures, cameras, ground, start, FOLLOWING, around=pose)
        if answer is None or (before is not None and answer.psnr < before[1].psnr - LOST_DB):
            start = Start(gem.rest_coefficients, pose)
            anew = fit(gem, pictures, cameras, ground, start, effort, around=pose)
            answer = anew if answer is None or anew.psnr > answer.psnr else answer
        before = timestep, answer
        yield FittedMoment(timestep, views, pictures, answer)


def _view(capture: Capture, shot: Shot) -> tuple[NDArray[np.uint8], Camera]:
    """The picture over its background, and its camera, no larger than LARGEST_SIDE."""
    picture = capture.over_background(shot)
    height, width = picture.shape[:2]
    shrink = min(1.0, LARGEST_SIDE / max(width, height))
    if shrink == 1:
        return picture, shot.camera
    size = round(width * shrink), round(height * shrink)
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8), shot.camera.scaled(*size)
