"""Splatting on all cores with a backward pass derived by hand: the tiles of ``render.software``, and their gradient."""

from typing import Any

import numpy as np
import torch
from torch import Tensor

from ..camera import Camera
from ..sorting import front_to_back
from ..tiles import TILE, count_pairs, fill_pairs
from .blending import blend, blend_back
from .projecting import SHAPE, SHARES, SUMS, project, project_back
from .tensors import GaussianTensors

MOST_PAIRS = 2**24
"""Of a splat and a tile that it reaches: each holds 42 bytes until the gradient is known, so 700 MB. A head in a
portrait has a hundredth of it."""


class TooManyPairs(ValueError):
    """Splats so large that their gradient would fill the memory."""


def render(
    gaussians: GaussianTensors, camera: Camera, world_to_camera: Tensor, background: Tensor | None = None
) -> Tensor:
    """[H, W, 4] float32 premultiplied RGBA of float32 splats, or [H, W, 3] RGB on ``background``, which is [3] or
    [H, W, 3]; ``world_to_camera`` is [4, 4]. Both may be of any precision. Raises TooManyPairs."""
    lens = np.array([camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height], np.float64)
    if background is not None:
        background = background.to(gaussians.positions)
        if background.numel() != 3:
            background = background.expand(camera.height, camera.width, 3)
        background = background.reshape(-1, 3)
    # laid by the kernels: in torch that takes as long as a quarter of all the rest
    return _Splatting.apply(*vars(gaussians).values(), world_to_camera, background, lens)  # type: ignore[no-any-return]


class _Splatting(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, *inputs: Any) -> Tensor:
        *tensors, world_to_camera, background, lens = inputs
        positions, wxyz, scales, opacities, colors = (tensor.detach().contiguous().numpy() for tensor in tensors)
        matrix = world_to_camera.detach().to(torch.float64).contiguous().numpy()
        ground = np.zeros((1, 3), np.float32) if background is None else background.detach().contiguous().numpy()
        count, width, height = len(positions), int(lens[4]), int(lens[5])
        centers, shapes = np.empty((count, 2)), np.empty((count, SHAPE), np.float32)
        spans, depths, firsts = np.empty((count, 4), np.int32), np.empty(count), np.empty(count + 1, np.int64)
        project(positions, wxyz, scales, opacities, colors, matrix, lens, centers, shapes, spans, depths, firsts)
        np.cumsum(firsts, out=firsts)
        if firsts[-1] > MOST_PAIRS:
            raise TooManyPairs(
                f"its {count:,} splats reach {firsts[-1]:,} tiles of a picture of {width}x{height}, more than"
                f" {MOST_PAIRS:,} together: they are far too large, or the camera is far too near"
            )
        orders = np.empty((2, count), np.int32)
        visible = front_to_back(depths, orders)
        columns, rows = -(-width // TILE), -(-height // TILE)
        ends = np.empty(columns * rows + 1, np.int64)
        count_pairs(depths, spans, columns, rows, ends)
        pairs = np.empty(int(ends[-1]), np.int32)
        fill_pairs(orders[0], visible, spans, columns, ends, 0, columns * rows, pairs)
        image = torch.empty(height, width, 4 if background is None else 3)
        bands = np.empty((len(pairs), 2), np.uint8)
        lights = np.empty((columns * rows, TILE, 2 * TILE), np.float32)
        blend(pairs, ends, centers, shapes, colors, ground, columns, rows, image.numpy(), bands, lights)
        ctx.save_for_backward(*tensors, world_to_camera, background)
        ctx.drawn = (pairs, ends, centers, shapes, colors, ground, spans, firsts, columns, rows, bands, lights)
        ctx.tiles = columns * rows
        ctx.placed = (positions, wxyz, scales, opacities, matrix, lens, firsts)
        return image

    @staticmethod
    def backward(ctx: Any, *grad_outputs: Any) -> Any:
        # raises where one was changed since: the arrays of forward share memory
        *tensors, camera, background = ctx.saved_tensors
        positions, wxyz, scales, opacities, matrix, lens, firsts = ctx.placed
        d_image = grad_outputs[0].contiguous().numpy()
        pixels = 0 if background is None else len(background)
        d_ground = np.empty((pixels if pixels > 1 else ctx.tiles, 3), np.float32)
        sums = np.empty((int(firsts[-1]), SUMS), np.float32)
        blend_back(*ctx.drawn, d_image, d_ground, sums)  # pyright: ignore[reportCallIssue]
        gradients = [torch.empty(tensor.shape) for tensor in tensors]
        shares = np.empty((SHARES, 3, 4))
        places, turns, sizes, peaks, hues = (gradient.numpy() for gradient in gradients)
        project_back(
            positions, wxyz, scales, opacities, matrix, lens, firsts, sums, places, turns, sizes, peaks, hues, shares
        )
        view = np.zeros((4, 4))
        view[:3] = shares.sum(0)
        if pixels <= 1:
            d_ground = d_ground.sum(0, np.float64, keepdims=True).astype(np.float32)
        d_background = None if background is None else torch.from_numpy(d_ground)
        return *gradients, torch.from_numpy(view).to(camera.dtype), d_background, None
