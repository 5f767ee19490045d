"""What pictures are compared by: the mean absolute difference, and structural similarity with its gradient."""

from typing import Any

import numba
import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

RADIUS = 5
"""The window of SSIM has 11 x 11 pixels ..."""
WINDOW_SIGMA = 1.5
"""... and falls off like this Gaussian, pixels (Wang et al. 2004)."""
C1, C2 = np.float32(0.01**2), np.float32(0.03**2)
SSIM_SHARE = 0.2
"""Of D-SSIM in the photometric loss of 3DGS; the rest is L1."""
_FAST = {"contract", "reassoc", "arcp", "nsz"}
_TAPS = np.exp(-((np.arange(2 * RADIUS + 1) - RADIUS) ** 2) / (2 * WINDOW_SIGMA**2))
_TAPS = (_TAPS / _TAPS.sum()).astype(np.float32)


def photometric(image: Tensor, target: Tensor) -> Tensor:
    """0.8 L1 + 0.2 (1 - SSIM) of pictures [H, W, 3]; the gradient is ``image``'s alone."""
    return (1 - SSIM_SHARE) * (image - target).abs().mean() + SSIM_SHARE * (1 - ssim(image, target))


def ssim(image: Tensor, target: Tensor) -> Tensor:
    """Structural similarity of two pictures [H, W, C] in [0, 1]: mean over pixels and channels.

    The edges see zeros beyond them, as in 3DGS. ``target`` gets no gradient. On the CPU, where pictures must be
    float32, it is done by hand, in a sixth of the time that convolutions take; on other devices by these.
    """
    if image.device.type != "cpu":
        return ssim_by_convolution(image, target)
    return _Ssim.apply(image, target)  # type: ignore[no-any-return]


def ssim_by_convolution(image: Tensor, target: Tensor) -> Tensor:
    """``ssim`` on any device and in any precision."""
    taps = torch.from_numpy(_TAPS).to(image)
    planes = [picture.permute(2, 0, 1)[:, None] for picture in (image, target.detach())]

    def mean(plane: Tensor) -> Tensor:
        rows = functional.conv2d(plane, taps.view(1, 1, -1, 1), padding=(RADIUS, 0))
        return functional.conv2d(rows, taps.view(1, 1, 1, -1), padding=(0, RADIUS))

    x, y = planes
    mx, my = mean(x), mean(y)
    c1, c2 = float(C1), float(C2)
    likeness = (2 * mx * my + c1) * (2 * (mean(x * y) - mx * my) + c2)
    spread = (mx * mx + my * my + c1) * (mean(x * x) - mx * mx + mean(y * y) - my * my + c2)
    return (likeness / spread).mean()


def psnr(image: Tensor, target: Tensor) -> float:
    """Decibels of ``image`` against ``target``, both in [0, 1]."""
    return float(-10 * torch.log10(((image - target) ** 2).mean() + 1e-12))


class _Ssim(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *inputs: Any) -> Tensor:
        image, target = inputs
        height, width, channels = image.shape
        x = image.detach().contiguous().numpy().reshape(height, -1)
        y = target.detach().contiguous().numpy().reshape(height, -1)
        moments = np.empty((5, height, width * channels), np.float32)
        _moments(x, y, moments)
        blurred = np.empty_like(moments)
        _blur(moments, channels, blurred)
        slopes, rows = moments[:3], np.empty(height)
        _compare(blurred, slopes, rows)
        _blur(slopes, channels, blurred[:3])
        ctx.save_for_backward(image, target)
        ctx.slopes = blurred
        return image.new_tensor(rows.sum() / x.size)

    @staticmethod
    def backward(ctx: Any, *grad_outputs: Any) -> Any:
        image, target = ctx.saved_tensors
        by_mean, by_square, by_product = (torch.from_numpy(plane).view(image.shape) for plane in ctx.slopes[:3])
        slope = by_mean + 2 * image * by_square + target * by_product
        return slope * (grad_outputs[0] / image.numel()), None


@numba.njit(cache=True, parallel=True, fastmath=_FAST)
def _moments(x, y, planes):
    for i in numba.prange(x.shape[0]):
        for j in range(x.shape[1]):
            a, b = x[i, j], y[i, j]
            planes[0, i, j], planes[1, i, j], planes[2, i, j] = a, b, a * a
            planes[3, i, j], planes[4, i, j] = b * b, a * b


@numba.njit(cache=True, parallel=True, fastmath=_FAST)
def _blur(planes, channels, out):
    """The window over each plane [P, H, W * C], rows then columns; it is its own transpose."""
    count, height, width = planes.shape
    pad = RADIUS * channels
    for i in numba.prange(height):
        row = np.zeros(width + 2 * pad, np.float32)
        inner = row[pad : pad + width]
        for p in range(count):
            inner[:] = 0
            for k in range(max(0, RADIUS - i), min(2 * RADIUS + 1, height + RADIUS - i)):
                tap, line = _TAPS[k], planes[p, i + k - RADIUS]
                for j in range(width):
                    inner[j] += tap * line[j]
            target = out[p, i]
            target[:] = 0
            for k in range(2 * RADIUS + 1):
                tap, line = _TAPS[k], row[k * channels : k * channels + width]
                for j in range(width):
                    target[j] += tap * line[j]


@numba.njit(cache=True, parallel=True, fastmath=_FAST)
def _compare(blurred, slopes, rows):
    """SSIM's sum of each row, and its derivatives by the blurred image, its square, and its product with the target."""
    for i in numba.prange(blurred.shape[1]):
        total = np.float32(0)
        for j in range(blurred.shape[2]):
            mx, my = blurred[0, i, j], blurred[1, i, j]
            a1, a2 = 2 * mx * my + C1, 2 * (blurred[4, i, j] - mx * my) + C2
            b1 = mx * mx + my * my + C1
            b2 = blurred[2, i, j] - mx * mx + blurred[3, i, j] - my * my + C2
            inverse = np.float32(1) / (b1 * b2)
            value = a1 * a2 * inverse
            total += value
            slopes[0, i, j] = 2 * my * (a2 - a1) * inverse - value * 2 * mx * (b2 - b1) * inverse
            slopes[1, i, j] = -value * b1 * inverse
            slopes[2, i, j] = 2 * a1 * inverse
        rows[i] = total
