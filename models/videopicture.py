"""A decoded frame of a video as the picture that its maker saw: upright, in its shape and colours."""

from fractions import Fraction

import av
import numpy as np
from av.video.reformatter import Colorspace
from numpy.typing import NDArray

LONGEST_SIDE = 1920
"""Larger pictures are scaled down while they are converted: the face networks look at crops of 256 pixels."""
_UNSAID = 2
"""The number of a matrix that a video does not name, in H.273."""


def upright_rgb(picture: av.VideoFrame, pixel_aspect: Fraction = Fraction(1)) -> NDArray[np.uint8]:
    """[H, W, 3] sRGB, at most LONGEST_SIDE, turned by the display matrix: phones film sideways and say so there.

    ``pixel_aspect``: width over height of the stored pixels; those that are returned are square.
    """
    _guess_colours(picture)
    width = float(picture.width * pixel_aspect)
    scale = min(1.0, LONGEST_SIDE / max(width, picture.height))
    size = max(1, round(width * scale)), max(1, round(picture.height * scale))
    if size != (picture.width, picture.height):
        picture = picture.reformat(*size, "rgb24")
    rgb = np.asarray(picture.to_ndarray(format="rgb24"), np.uint8)
    quarter_turns = round(picture.rotation / 90) % 4  # counter-clockwise, as np.rot90 turns
    return np.ascontiguousarray(np.rot90(rgb, quarter_turns)) if quarter_turns else rgb


def _guess_colours(picture: av.VideoFrame) -> None:
    """Large pictures that do not say how they become RGB are BT.709 to players; to FFmpeg they are BT.601."""
    if picture.colorspace == _UNSAID and not picture.format.is_rgb and (picture.width >= 1280 or picture.height > 576):
        picture.colorspace = Colorspace.ITU709
