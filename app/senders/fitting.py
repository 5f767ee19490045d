"""Pictures of any size onto an output of one size: a window may be resized, a file and a camera may not."""

import cv2
import numpy as np

from ...render.arrays import Image

Size = tuple[int, int]
"""Width and height in pixels."""


def even(size: Size) -> Size:
    """The size without an odd last row or column: video shares colours between pairs of pixels."""
    return max(2, size[0] // 2 * 2), max(2, size[1] // 2 * 2)


def fitted(picture: Image, size: Size, backdrop: tuple[int, int, int] | None) -> Image:
    """The whole picture, as large as it goes, in the middle of ``size``.

    Args:
        picture: [H, W, 3] RGB or [H, W, 4] with straight alpha.
        size: of the result.
        backdrop: RGB behind what is transparent and at the borders; the result is [h, w, 3]. None keeps alpha, borders
            are transparent, and the result is [h, w, 4].
    """
    if backdrop is None and picture.shape[2] == 3:
        picture = np.dstack([picture, np.full(picture.shape[:2], 255, np.uint8)])
    if backdrop is not None and picture.shape[2] == 4:
        picture = _over(picture, backdrop)
    if (picture.shape[1], picture.shape[0]) == size:
        return picture
    scale = min(size[0] / picture.shape[1], size[1] / picture.shape[0])
    height, width = (max(1, round(scale * side)) for side in picture.shape[:2])
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    inner = _resized(picture, (width, height), how)
    result = np.empty((size[1], size[0], picture.shape[2]), np.uint8)
    result[:] = (0, 0, 0, 0) if backdrop is None else backdrop
    top, left = (size[1] - height) // 2, (size[0] - width) // 2
    result[top : top + height, left : left + width] = inner
    return result


def _resized(picture: Image, size: Size, how: int) -> Image:
    """With alpha as seen: what is transparent has no colour to lend to what is beside it."""
    if picture.shape[2] == 3:
        return np.asarray(cv2.resize(picture, size, interpolation=how), np.uint8)
    resized = cv2.resize(cv2.cvtColor(picture, cv2.COLOR_RGBA2mRGBA), size, interpolation=how)
    return np.asarray(cv2.cvtColor(resized, cv2.COLOR_mRGBA2RGBA), np.uint8)


def _over(picture: Image, backdrop: tuple[int, int, int]) -> Image:
    alpha = picture[..., 3:].astype(np.uint16)
    behind = np.array(backdrop, np.uint16)
    return ((picture[..., :3] * alpha + behind * (255 - alpha) + 127) // 255).astype(np.uint8)
