"""A picture on its background, and the gradient of that: in torch a quarter of the time of all of drawing."""

from typing import Any

import numba
import numpy as np
import torch
from torch import Tensor

_SHARES = 16
"""The gradient of a single colour is summed in so many shares, whatever the threads."""


def lay(image: Tensor, background: Tensor) -> Tensor:
    """Premultiplied RGBA [H, W, 4] on RGB [3], or anything that is broadcast to [H, W, 3]: RGB [H, W, 3]. Both are
    float32 on the CPU."""
    if background.numel() != 3:
        background = background.expand(*image.shape[:2], 3)
    return _Laying.apply(image, background.reshape(-1, 3))  # type: ignore[no-any-return]


class _Laying(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *inputs: Any) -> Tensor:
        image, ground = (tensor.detach().contiguous() for tensor in inputs)
        ctx.save_for_backward(image, ground)
        picture = torch.empty(*image.shape[:2], 3)
        _lay(image.numpy().reshape(-1, 4), ground.numpy(), picture.numpy().reshape(-1, 3))
        return picture

    @staticmethod
    def backward(ctx: Any, *grad_outputs: Any) -> Any:
        image, ground = ctx.saved_tensors
        wanted = grad_outputs[0].contiguous().numpy().reshape(-1, 3)
        d_image, shares = torch.empty(image.shape), np.empty((_SHARES, 3))
        everywhere = np.empty((len(ground) if len(ground) > 1 else 0, 3), np.float32)
        pixels = image.numpy().reshape(-1, 4), ground.numpy()
        _lay_back(*pixels, wanted, d_image.numpy().reshape(-1, 4), everywhere, shares)
        d_ground = everywhere if len(everywhere) else shares.sum(0, keepdims=True).astype(np.float32)
        return d_image, torch.from_numpy(d_ground)


@numba.njit(cache=True, parallel=True, error_model="numpy")
def _lay(image, ground, picture):
    """Pixels float32 [P, 4] on ``ground`` [P, 3], or [1, 3] for all: ``picture`` [P, 3]."""
    step = 1 if len(ground) > 1 else 0
    for p in numba.prange(len(image)):
        clear = np.float32(1) - image[p, 3]
        for k in range(3):
            picture[p, k] = image[p, k] + clear * ground[p * step, k]


@numba.njit(cache=True, parallel=True, error_model="numpy")
def _lay_back(image, ground, wanted, d_image, everywhere, shares):
    """From the picture's gradient ``wanted`` [P, 3] that of the pixels, and of the ground: pixel by pixel into
    ``everywhere`` [P, 3] unless it is empty, and summed over shares of all pixels into ``shares`` float64."""
    step, pixels = 1 if len(ground) > 1 else 0, len(image)
    for share in numba.prange(_SHARES):
        red, green, blue = 0.0, 0.0, 0.0
        for p in range(share * pixels // _SHARES, (share + 1) * pixels // _SHARES):
            r, g, b = wanted[p, 0], wanted[p, 1], wanted[p, 2]
            d_image[p, 0], d_image[p, 1], d_image[p, 2] = r, g, b
            d_image[p, 3] = -(r * ground[p * step, 0] + g * ground[p * step, 1] + b * ground[p * step, 2])
            clear = np.float32(1) - image[p, 3]
            red += clear * r
            green += clear * g
            blue += clear * b
            if len(everywhere):
                everywhere[p, 0], everywhere[p, 1], everywhere[p, 2] = clear * r, clear * g, clear * b
        shares[share, 0], shares[share, 1], shares[share, 2] = red, green, blue
