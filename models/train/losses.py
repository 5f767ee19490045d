"""What pictures are compared by: the mean absolute difference, and structural similarity with its gradient."""

from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from ..metrics.structure import C1, C2, RADIUS, TAPS, blur, compare, moments

SSIM_SHARE = 0.2
"""Of D-SSIM in the photometric loss of 3DGS; the rest is L1."""


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
    taps = torch.from_numpy(TAPS).to(image)
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
        planes = np.empty((5, height, width * channels), np.float32)
        moments(x, y, planes)
        blurred, values = np.empty_like(planes), np.empty_like(x)
        blur(planes, channels, blurred)
        slopes = planes[:3]
        compare(blurred, slopes, values)
        blur(slopes, channels, blurred[:3])
        ctx.save_for_backward(image, target)
        ctx.slopes = blurred
        return image.new_tensor(values.mean(dtype=np.float64))

    @staticmethod
    def backward(ctx: Any, *grad_outputs: Any) -> Any:
        image, target = ctx.saved_tensors
        by_mean, by_square, by_product = (torch.from_numpy(plane).view(image.shape) for plane in ctx.slopes[:3])
        slope = by_mean + 2 * image * by_square + target * by_product
        return slope * (grad_outputs[0] / image.numel()), None
