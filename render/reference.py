"""The oracle of every engine: float64, one splat after the other, slow and plain."""

import numba
import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .gaussians import Gaussians
from .projection import ALPHA_MAX, ALPHA_MIN, NEAR, TRANSMITTANCE_MIN, project


def render_reference(gaussians: Gaussians, camera: Camera) -> NDArray[np.float64]:
    """The picture [H, W, 4], premultiplied sRGB-encoded RGBA in [0, 1] on transparent ground.

    Front to back by depth, ties by index. Every value of ``gaussians`` must be finite: this judges engines, it does not
    survive what they must survive.
    """
    centers, covariances, depths = project(gaussians, camera)
    opacities = np.asarray(gaussians.opacities, np.float64)
    order = np.argsort(depths, kind="stable")
    order = order[(depths[order] >= NEAR) & (opacities[order] >= ALPHA_MIN)]
    image = np.zeros((camera.height, camera.width, 4))
    light = np.ones((camera.height, camera.width))
    _splat(order, centers, covariances, opacities, np.asarray(gaussians.colors, np.float64), image, light)
    image[..., 3] = 1 - light
    return image


@numba.njit(cache=True)
def _pixels(start, end, size):
    return int(np.floor(min(max(start, 0.0), size))), int(np.ceil(min(max(end, 0.0), size)))


@numba.njit(cache=True)
def _splat(order, centers, covariances, opacities, colors, image, light):
    height, width = light.shape
    least, most, darkest = np.float64(ALPHA_MIN), np.float64(ALPHA_MAX), np.float64(TRANSMITTANCE_MIN)
    for i in order:
        a, b, c = covariances[i, 0, 0], covariances[i, 0, 1], covariances[i, 1, 1]
        determinant = a * c - b * b
        reach = np.sqrt(2 * max(np.log(opacities[i] / least), 0.0))
        x, y = centers[i]
        half_x, half_y = reach * np.sqrt(a), reach * np.sqrt(c)
        left, right = _pixels(x - half_x, x + half_x, width)
        top, bottom = _pixels(y - half_y, y + half_y, height)
        for row in range(top, bottom):
            for column in range(left, right):
                if light[row, column] < darkest:
                    continue
                dx, dy = column + 0.5 - x, row + 0.5 - y
                power = -0.5 * (c * dx * dx - 2 * b * dx * dy + a * dy * dy) / determinant
                alpha = min(opacities[i] * np.exp(power), most)
                if alpha < least:
                    continue
                for channel in range(3):
                    image[row, column, channel] += light[row, column] * alpha * colors[i, channel]
                light[row, column] *= 1 - alpha
