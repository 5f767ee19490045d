"""A decoded frame of a video as the picture that its maker saw: upright, in its shape and colours."""

from fractions import Fraction

import av
import numpy as np
from av.video.reformatter import Colorspace
from numpy.typing import NDArray

from .highrange import as_srgb, is_no_srgb

LONGEST_SIDE = 1920
"""Larger pictures are scaled down while they are converted: the face networks look at crops of 256 pixels."""
_UNSAID = 2
"""The number of a matrix that a video does not name, in H.273."""


def upright_rgb(picture: av.VideoFrame, pixel_aspect: Fraction = Fraction(1)) -> NDArray[np.uint8]:
    """[H, W, 3] sRGB, at most LONGEST_SIDE, turned by the display matrix: phones film sideways and say so there.

    ``pixel_aspect``: width over height of the stored pixels; those that are returned are square.
    """
    _guess_colours(picture)
    transfer, primaries = picture.color_trc, picture.color_primaries
    kind = "rgb48le" if is_no_srgb(transfer, primaries) else "rgb24"
    matrix = _display_matrix(picture)
    width = float(picture.width * pixel_aspect)
    scale = min(1.0, LONGEST_SIDE / max(width, picture.height))
    size = max(1, round(width * scale)), max(1, round(picture.height * scale))
    if size != (picture.width, picture.height):
        picture = picture.reformat(*size, kind)
    stored = picture.to_ndarray(format=kind)
    wide = stored.dtype == np.uint16
    rgb = as_srgb(np.asarray(stored, np.uint16), transfer, primaries) if wide else np.asarray(stored, np.uint8)
    return rgb if matrix is None else displayed(rgb, matrix)


def displayed(rgb: NDArray[np.uint8], matrix: NDArray[np.integer]) -> NDArray[np.uint8]:
    """[H, W, 3], turned by quarters and mirrored as ``matrix`` [2, 2] says: x, y of the stored picture (row vectors, y
    down) times it are those of the shown one, but for their scale and origin."""
    (a, b), (c, d) = matrix.tolist()
    if abs(b) + abs(c) > abs(a) + abs(d):
        rgb, across, down = rgb.transpose(1, 0, 2), c, b
    else:
        across, down = a, d
    return np.ascontiguousarray(rgb[:: -1 if down < 0 else 1, :: -1 if across < 0 else 1])


def _display_matrix(picture: av.VideoFrame) -> NDArray[np.int32] | None:
    """[2, 2] of the 3 x 3 fixed-point numbers that a container keeps; None where it says nothing."""
    told = picture.side_data.get("DISPLAYMATRIX")
    if told is None:
        return None
    numbers = np.frombuffer(bytes(told), np.int32)
    return numbers.reshape(3, 3)[:2, :2] if numbers.size == 9 else None


def _guess_colours(picture: av.VideoFrame) -> None:
    """Large pictures that do not say how they become RGB are BT.709 to players; to FFmpeg they are BT.601."""
    if picture.colorspace == _UNSAID and not picture.format.is_rgb and (picture.width >= 1280 or picture.height > 576):
        picture.colorspace = Colorspace.ITU709
