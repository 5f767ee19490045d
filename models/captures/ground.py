"""What is behind the person: known by a mask, or by the colour that the capture states, or taken for the person."""

from pathlib import Path

import numpy as np

from .reader import Capture

LOOKED_AT = 6
"""Pictures, over the whole of the training ones."""
APART = 24
"""Of 255: a border that is off by more in most of its pixels is no plain ground."""


def room_behind(capture: Capture) -> Path | None:
    """A training picture without a mask in which something else than the capture's background is behind the person;
    None where there is none. What is learned of such pictures takes the room for the person.

    The upper edge and the upper halves of the sides are looked at: shoulders leave a picture below.
    Raises CaptureError where a file changed since the capture was opened.
    """
    shots = capture.train
    ground = 255 * np.array(capture.background)
    for index in sorted({len(shots) * part // LOOKED_AT for part in range(LOOKED_AT)} & set(range(len(shots)))):
        rgba = capture.read(shots[index])
        if rgba[..., 3].min() < 255:
            continue
        upper = rgba[: len(rgba) // 2, :, :3].astype(np.float64)
        border = np.concatenate([upper[0], upper[:, 0], upper[:, -1]])
        if np.median(np.abs(border - ground).max(1)) > APART:
            return shots[index].picture
    return None
