"""Side by side: the driver's picture to the left of the avatar's."""

import numpy as np

from ...render.arrays import Image

ROUNDED_PX = 2
"""So much narrower or lower pictures fill the room: a video's width is rounded to an even number."""
WIDEST = 3
"""Heights. A wider picture of a driver stays lower than the avatar's: beside the largest avatar, of 4096 pixels a side,
H.264 has room for no more (16384)."""


def beside_width(driver_size: tuple[int, int], height: int) -> int:
    """Width in pixels, even, of the driver scaled to ``height``; at most WIDEST times that."""
    width, full_height = driver_size
    return max(2, 2 * round(min(width / full_height, WIDEST) * height / 2))


def side_by_side(driver: Image, avatar: Image, width: int) -> Image:
    """[H, width + W, C] the driver [h, w, 3] scaled to fit the avatar's height and ``width``, white where its shape is
    another one, then the avatar [H, W, C]."""
    import cv2

    height = avatar.shape[0]
    picture = np.full((height, width + avatar.shape[1], avatar.shape[2]), 255, np.uint8)
    picture[:, width:] = avatar
    scale = min(width / driver.shape[1], height / driver.shape[0])
    fitted = [round(side * scale) for side in driver.shape[1::-1]]
    wide, high = (
        room if room - side <= ROUNDED_PX else max(1, side) for room, side in zip((width, height), fitted, strict=True)
    )
    left, top = (width - wide) // 2, (height - high) // 2
    method = cv2.INTER_AREA if driver.shape[0] > high else cv2.INTER_LINEAR
    picture[top : top + high, left : left + wide, :3] = cv2.resize(driver, (wide, high), interpolation=method)
    return picture
