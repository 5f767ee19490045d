"""The turned square of the image that the landmark network looks at."""

from dataclasses import dataclass
from math import atan2, ceil, cos, hypot, remainder, sin, sqrt, tau

import cv2
import numpy as np
from numpy.typing import NDArray

from .points import LEFT_EYE_OUTER, RIGHT_EYE_OUTER

_MARGIN = 1.5
"""Side of the square over the extent of the landmarks."""
_SHRUNK_FROM = 1.75
"""Pixels of the image for one of the crop: from so many on, and again for each whole one more, they are averaged."""


@dataclass(frozen=True)
class Region:
    """A square in the image, turned with the head."""

    x: float
    """Centre, pixels."""
    y: float
    """Centre, pixels."""
    size: float
    """Side, pixels, > 0."""
    tilt: float
    """Angle of the eye line, radians, clockwise on the screen."""

    def scaled(self, across: float, down: float) -> "Region":
        """The same place in an image that is so many times as wide and high."""
        return Region(self.x * across, self.y * down, self.size * sqrt(across * down), self.tilt)

    def apart(self, other: "Region") -> float:
        """How far off another region of the same image is: how far its centre is or how much larger it is, in sides of
        this one, or how it is tilted against it, in radians, whichever is most."""
        way = hypot(other.x - self.x, other.y - self.y)
        return max(way / self.size, abs(other.size / self.size - 1), abs(remainder(other.tilt - self.tilt, tau)))

    def to_image(self, side: int) -> NDArray[np.float64]:
        """[2, 3] affine map from a crop of ``side`` pixels to the image, both with pixel centres at half integers."""
        scale = self.size / side
        cosine, sine = scale * cos(self.tilt), scale * sin(self.tilt)
        half = side / 2
        return np.array(
            [
                [cosine, -sine, self.x - (cosine - sine) * half],
                [sine, cosine, self.y - (sine + cosine) * half],
            ]
        )

    def crop(self, rgb: NDArray[np.uint8], side: int) -> NDArray[np.uint8]:
        """The square as an upright picture [side, side, 3]; what lies outside the image repeats its border. Of a large
        face each pixel is a mean of those that it stands for: sampled among four, it would have all of their grain."""
        times = int(self.size / side + 2 - _SHRUNK_FROM)
        part = self._part(rgb, times) if times > 1 else None
        if part is not None:
            return part[0].crop(part[1], side)
        matrix = self.to_image(side)
        matrix[:, 2] += (matrix[:, 0] + matrix[:, 1] - 1) / 2  # OpenCV counts from the centre of the first pixel
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        crop = cv2.warpAffine(rgb, matrix, (side, side), flags=flags, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(crop, np.uint8)

    def _part(self, rgb: NDArray[np.uint8], times: int) -> tuple["Region", NDArray[np.uint8]] | None:
        """The same place in the part of the image about it, shrunk so many times; None where there is nothing of it.
        Which pixels are averaged together depends on the image alone, so that nothing swims as the face moves."""
        x, y, reach = self.x / times, self.y / times, self.size / times * sqrt(0.5)
        height, width = (side // times for side in rgb.shape[:2])
        left, top = max(0, int(x - reach)), max(0, int(y - reach))
        right, bottom = min(width, ceil(x + reach) + 1), min(height, ceil(y + reach) + 1)
        if right <= left or bottom <= top:
            return None
        part = rgb[top * times : bottom * times, left * times : right * times]
        shrunk = cv2.resize(part, (right - left, bottom - top), interpolation=cv2.INTER_AREA)
        return Region(x - left, y - top, self.size / times, self.tilt), np.asarray(shrunk, np.uint8)


def region_around(landmarks: NDArray[np.float64]) -> Region:
    """The region for the next frame: a square around landmarks [n, >= 2] in pixels, upright along their eye line."""
    tilt = eye_line_tilt(landmarks)
    cosine, sine = cos(tilt), sin(tilt)
    across = landmarks[:, 0] * cosine + landmarks[:, 1] * sine
    down = landmarks[:, 1] * cosine - landmarks[:, 0] * sine
    left, right, top, bottom = (float(edge) for edge in (across.min(), across.max(), down.min(), down.max()))
    u, v = (left + right) / 2, (top + bottom) / 2
    size = max(right - left, bottom - top) * _MARGIN
    return Region(u * cosine - v * sine, u * sine + v * cosine, size, tilt)


def eye_line_tilt(landmarks: NDArray[np.float64]) -> float:
    """Angle, radians, of the line through the outer eye corners."""
    left, right = landmarks[LEFT_EYE_OUTER], landmarks[RIGHT_EYE_OUTER]
    return atan2(left[1] - right[1], left[0] - right[0])
