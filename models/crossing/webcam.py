"""What the sensor of a webcam does to a picture that stands still."""

import cv2
import numpy as np

from ...render.arrays import Image

READ_NOISE, SHOT_NOISE = 0.002, 0.0004
"""Standard deviation in the dark, and variance per light, in parts of full scale of linear light: at mid grey two to
three of 255 levels, as a webcam has in a lit room in the evening."""
GAMMA = 2.2
BLUR = np.array([0.25, 0.5, 0.25], np.float32)
"""Neighbours share their noise: each pixel's colours are made of several cells of the sensor."""
QUALITY = 85
"""Of the JPEGs in which webcams send their pictures."""


def resensed(picture: Image, box_px: tuple[int, int, int, int], rng: np.random.Generator) -> Image:
    """The picture [H, W, 3] with fresh noise inside a box (left, top, right, bottom), elsewhere as it was."""
    left, top, right, bottom = box_px
    light = (picture[top:bottom, left:right].astype(np.float32) / 255) ** GAMMA
    noise = cv2.sepFilter2D(rng.standard_normal(light.shape, np.float32), -1, BLUR, BLUR) / (BLUR**2).sum()
    light = light + noise * np.sqrt(READ_NOISE**2 + SHOT_NOISE * light)
    sensed = np.round(255 * np.clip(light, 0, 1) ** (1 / GAMMA)).astype(np.uint8)
    sent = cv2.imencode(".jpg", sensed, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
    answer = picture.copy()
    answer[top:bottom, left:right] = np.asarray(cv2.imdecode(sent, cv2.IMREAD_COLOR), np.uint8)
    return answer
