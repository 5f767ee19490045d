"""The SYNTHETIC badge: a small mark in the corner of what is exported, which says that nobody filmed this face."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Image

WORD = "SYNTHETIC"
LETTER_SHARE = 0.021
"""Height of a capital, as a part of the picture's shorter side."""
SMALLEST_LETTER = 8
"""Pixels: less cannot be read after a video's compression."""
WIDEST = 0.92
"""Of the picture's width: where that is too little, letters are smaller; under 60 pixels none can be read."""
PLATE, PLATE_OPACITY = (18, 20, 23), 0.62
INK = (245, 246, 248)
_OVERSAMPLED = 8
"""Letters are drawn so many times larger and scaled down: the strokes get soft edges on any pixel grid."""
_STROKE = 0.15
_TRACKING, _PAD_X, _PAD_Y, _MARGIN = 0.24, 0.85, 0.62, 0.9
"""Between letters, inside the plate and outside of it, in heights of a capital, as the stroke is."""


def badged(picture: Image) -> Image:
    """A copy of a picture with the badge in its lower right corner, on the avatar's side of two pictures.

    Args:
        picture: [H, W, 3] sRGB, or [H, W, 4] with straight alpha: the badge brings its own ground.
    """
    result = picture.copy()
    ink, opacity = _mark(*picture.shape[:2])
    rows, columns = opacity.shape
    height, width = picture.shape[:2]
    margin = max(0, min(round(_MARGIN * letter_height(height, width)), height - rows, width - columns))
    bottom, right = height - margin, width - margin
    place = result[bottom - rows : bottom, right - columns : right]
    over = opacity[..., None]
    if picture.shape[2] == 3:
        place[:] = np.rint(place * (1 - over) + ink * over)
        return result
    behind = (place[..., 3:] / np.float32(255)) * (1 - over)
    alpha = over + behind
    place[..., :3] = np.rint((place[..., :3] * behind + ink * over) / np.maximum(alpha, 1 / 255))
    place[..., 3:] = np.rint(alpha * 255)
    return result


def letter_height(height: int, width: int) -> int:
    """Pixels of a capital in a picture of this size."""
    wanted = max(SMALLEST_LETTER, round(LETTER_SHARE * min(height, width)))
    across = int(WIDEST * width / (_word_share() + 2 * _PAD_X))
    return max(1, min(wanted, across, int(WIDEST * height / (1 + 2 * _PAD_Y))))


@lru_cache(maxsize=16)
def _mark(height: int, width: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Colour [h, w, 3] in 0..255 and opacity [h, w] in 0..1 of the badge for a picture of this size."""
    import cv2

    fine = letter_height(height, width) * _OVERSAMPLED
    word = _word(fine)
    high, wide = round(fine * (1 + 2 * _PAD_Y)), round(word.shape[1] + 2 * _PAD_X * fine)
    high, wide = (-(-side // _OVERSAMPLED) * _OVERSAMPLED for side in (high, wide))
    ink = np.zeros((high, wide), np.uint8)
    top, left = (high - fine) // 2, (wide - word.shape[1]) // 2
    ink[top : top + fine, left : left + word.shape[1]] = word
    plate = np.zeros((high, wide), np.uint8)
    radius = round(0.32 * high)
    cv2.rectangle(plate, (radius, 0), (wide - 1 - radius, high - 1), 255, -1)
    cv2.rectangle(plate, (0, radius), (wide - 1, high - 1 - radius), 255, -1)
    for x in (radius, wide - 1 - radius):
        for y in (radius, high - 1 - radius):
            cv2.circle(plate, (x, y), radius, 255, -1)
    size = (min(width, wide // _OVERSAMPLED), min(height, high // _OVERSAMPLED))
    ink, plate = (cv2.resize(mask, size, interpolation=cv2.INTER_AREA) for mask in (ink, plate))
    inked = ink.astype(np.float32)[..., None] / 255
    colour = np.array(PLATE, np.float32) * (1 - inked) + np.array(INK, np.float32) * inked
    opacity = np.maximum(plate.astype(np.float32) / 255 * np.float32(PLATE_OPACITY), inked[..., 0])
    return np.asarray(colour, np.float32), np.asarray(opacity, np.float32)


def _word(height: int) -> Image:
    """The word in round strokes, [height, w] coverage in 0..255; letters stand apart as capitals on a sign do."""
    gap = np.zeros((height, round(_TRACKING * height)), np.uint8)
    parts = [part for letter in WORD for part in (_letter(letter, height), gap)]
    return np.hstack(parts[:-1])


def _letter(letter: str, height: int) -> Image:
    """One letter, cut to its ink: the strokes of OpenCV's plain font at a width of our own."""
    import cv2

    stroke = max(1, round(_STROKE * height))
    scale = (height - stroke) / (cv2.getTextSize("H", cv2.FONT_HERSHEY_SIMPLEX, 10, 1)[0][1] / 10)
    canvas = np.zeros((2 * height, 3 * height), np.uint8)
    place = (height // 2 + stroke, height + height // 2)
    cv2.putText(canvas, letter, place, cv2.FONT_HERSHEY_SIMPLEX, scale, 255, stroke, cv2.LINE_AA)
    rows, columns = (np.flatnonzero(canvas.any(axis)) for axis in (1, 0))
    cut = canvas[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    return np.asarray(cv2.resize(cut, (cut.shape[1], height), interpolation=cv2.INTER_AREA), np.uint8)


@lru_cache(maxsize=1)
def _word_share() -> float:
    """Width of the word, in heights of a capital."""
    return _word(80).shape[1] / 80
