"""Structural similarity (Wang et al. 2004) on all cores: the kernels behind the metric here and the loss in training.

The edges see zeros beyond them, as in 3DGS and what was compared by its code.
"""

import numba
import numpy as np
from numpy.typing import NDArray

from .pixels import weighed

RADIUS = 5
"""The window of SSIM has 11 x 11 pixels ..."""
WINDOW_SIGMA = 1.5
"""... and falls off like this Gaussian, pixels."""
C1, C2 = np.float32(0.01**2), np.float32(0.03**2)
_FAST = {"contract", "reassoc", "arcp", "nsz"}
TAPS = np.exp(-((np.arange(2 * RADIUS + 1) - RADIUS) ** 2) / (2 * WINDOW_SIGMA**2))
TAPS = (TAPS / TAPS.sum()).astype(np.float32)
"""[11] the window along one axis."""


def ssim(image: NDArray[np.floating], target: NDArray[np.floating], mask: NDArray[np.floating] | None = None) -> float:
    """Structural similarity of two pictures [H, W, C] in [0, 1]: 1 for equal ones, larger is better.

    The mean over channels and pixels, each as much as ``mask`` [H, W] says.
    """
    return weighed(ssim_map(image, target), mask)


def ssim_map(image: NDArray[np.floating], target: NDArray[np.floating]) -> NDArray[np.float32]:
    """[H, W, C] structural similarity around each pixel."""
    if image.shape != target.shape or image.ndim != 3:
        raise ValueError(f"two pictures [H, W, C] of one size are compared, got {image.shape} and {target.shape}")
    height, _, channels = image.shape
    x, y = (np.ascontiguousarray(picture, np.float32).reshape(height, -1) for picture in (image, target))
    planes = np.empty((5, *x.shape), np.float32)
    moments(x, y, planes)
    blurred, values = np.empty_like(planes), np.empty_like(x)
    blur(planes, channels, blurred)
    compare(blurred, planes[:3], values)
    return values.reshape(image.shape)


@numba.njit(cache=True, parallel=True, fastmath=_FAST)
def moments(x, y, planes):
    for i in numba.prange(x.shape[0]):
        for j in range(x.shape[1]):
            a, b = x[i, j], y[i, j]
            planes[0, i, j], planes[1, i, j], planes[2, i, j] = a, b, a * a
            planes[3, i, j], planes[4, i, j] = b * b, a * b


@numba.njit(cache=True, parallel=True, fastmath=_FAST)
def blur(planes, channels, out):
    """The window over each plane [P, H, W * C], rows then columns; it is its own transpose."""
    count, height, width = planes.shape
    pad = RADIUS * channels
    for i in numba.prange(height):
        row = np.zeros(width + 2 * pad, np.float32)
        inner = row[pad : pad + width]
        for p in range(count):
            inner[:] = 0
            for k in range(max(0, RADIUS - i), min(2 * RADIUS + 1, height + RADIUS - i)):
                tap, line = TAPS[k], planes[p, i + k - RADIUS]
                for j in range(width):
                    inner[j] += tap * line[j]
            target = out[p, i]
            target[:] = 0
            for k in range(2 * RADIUS + 1):
                tap, line = TAPS[k], row[k * channels : k * channels + width]
                for j in range(width):
                    target[j] += tap * line[j]


@numba.njit(cache=True, parallel=True, fastmath=_FAST)
def compare(blurred, slopes, values):
    """SSIM of each pixel [H, W * C], and its derivatives by the blurred image, its square, and its product with the
    target. ``slopes`` may be the first planes of the moments."""
    for i in numba.prange(blurred.shape[1]):
        for j in range(blurred.shape[2]):
            mx, my = blurred[0, i, j], blurred[1, i, j]
            a1, a2 = 2 * mx * my + C1, 2 * (blurred[4, i, j] - mx * my) + C2
            b1 = mx * mx + my * my + C1
            b2 = blurred[2, i, j] - mx * mx + blurred[3, i, j] - my * my + C2
            inverse = np.float32(1) / (b1 * b2)
            value = a1 * a2 * inverse
            values[i, j] = value
            slopes[0, i, j] = 2 * my * (a2 - a1) * inverse - value * 2 * mx * (b2 - b1) * inverse
            slopes[1, i, j] = -value * b1 * inverse
            slopes[2, i, j] = 2 * a1 * inverse
