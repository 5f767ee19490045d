"""Side by side: the driver's picture to the left of the avatar's."""

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]


def beside_width(driver_size: tuple[int, int], height: int) -> int:
    """Width in pixels, even, of the driver scaled to ``height``."""
    width, full_height = driver_size
    return max(2, 2 * round(width * height / full_height / 2))


def side_by_side(driver: Image, avatar: Image, width: int) -> Image:
    """[H, width + W, C] the driver [h, w, 3] scaled to the avatar's height and ``width``, then the avatar [H, W, C]."""
    import cv2

    height = avatar.shape[0]
    method = cv2.INTER_AREA if driver.shape[0] > height else cv2.INTER_LINEAR
    picture = np.full((height, width + avatar.shape[1], avatar.shape[2]), 255, np.uint8)
    picture[:, :width, :3] = cv2.resize(driver, (width, height), interpolation=method)
    picture[:, width:] = avatar
    return picture
