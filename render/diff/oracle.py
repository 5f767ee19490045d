"""The oracle of the differentiable engines: plain torch, one row per splat and pixel, gradients by torch alone."""

import torch
from torch import Tensor
from torch.nn import functional

from ..camera import Camera
from ..projection import ALPHA_MAX, ALPHA_MIN, DILATION, NEAR, TRANSMITTANCE_MIN, VIEW_MARGIN
from .tensors import GaussianTensors

_LEAST, _MOST, _DARKEST = float(ALPHA_MIN), float(ALPHA_MAX), float(TRANSMITTANCE_MIN)


def render(gaussians: GaussianTensors, camera: Camera, world_to_camera: Tensor) -> Tensor:
    """[H, W, 4] premultiplied RGBA. ``world_to_camera`` [4, 4] has the dtype and device of the splats."""
    kept = _drawable(gaussians, world_to_camera)
    centers, conics, extents, depths = _project(kept, camera, world_to_camera)
    order = torch.argsort(depths.detach(), stable=True)
    rows = torch.cat([centers, conics, kept.opacities[:, None], kept.colors], 1)[order]
    with torch.no_grad():
        splat, pixel = _pairs(rows, extents[order], camera)
    alpha = _alphas(rows[splat], pixel, camera.width)
    pixels = camera.width * camera.height
    # light in front of each pair: the sum of logarithms up to it, less what the pixels before had summed up
    fading = torch.log1p(-alpha).double()
    before = torch.cumsum(fading, 0) - fading
    start = torch.searchsorted(pixel, torch.arange(pixels, device=pixel.device))
    base = torch.cat([before, before.new_zeros(1)])[start]
    light = (before - base[pixel]).exp().to(alpha.dtype)
    weight = torch.where(light.detach() >= _DARKEST, alpha * light, 0.0)
    drawn = torch.cat([weight[:, None] * rows[splat, 6:], weight[:, None]], 1)
    image = drawn.new_zeros(pixels, 4).index_add(0, pixel, drawn)
    return image.view(camera.height, camera.width, 4)


def _drawable(gaussians: GaussianTensors, world_to_camera: Tensor) -> GaussianTensors:
    with torch.no_grad():
        finite = torch.stack(
            [tensor.isfinite().view(len(gaussians), tensor[:1].numel()).all(1) for tensor in vars(gaussians).values()]
        )
        depths = gaussians.positions.double() @ world_to_camera[2, :3].double() + world_to_camera[2, 3].double()
        keep = finite.all(0) & (depths >= float(NEAR)) & (gaussians.opacities >= _LEAST)
    return GaussianTensors(*(tensor[keep] for tensor in vars(gaussians).values()))


def _project(splats: GaussianTensors, camera: Camera, matrix: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Centres [N, 2], conics [N, 3], half extents [N, 2] of the box that holds all alphas of 1/255, depths [N]."""
    like = splats.positions
    focal = like.new_tensor([camera.fx, camera.fy])
    principal = like.new_tensor([camera.cx, camera.cy])
    size = like.new_tensor([camera.width, camera.height])
    seen = like @ matrix[:3, :3].T + matrix[:3, 3]
    slopes = seen[:, :2] / seen[:, 2:]
    margin = float(VIEW_MARGIN)
    bounded = slopes.clamp((-margin * size - principal) / focal, ((1 + margin) * size - principal) / focal)
    axes = matrix[:3, :3] @ _rotations(splats.wxyz) * splats.scales[:, None]
    flat = (focal / seen[:, 2:])[..., None] * (axes[:, :2] - bounded[..., None] * axes[:, 2:])
    covariance = flat @ flat.transpose(1, 2) + float(DILATION) * torch.eye(2, dtype=like.dtype, device=like.device)
    a, b, c = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    determinant = a * c - b * b
    conics = torch.stack([c, -b, a], 1) / determinant[:, None]
    reach = (2 * (splats.opacities / _LEAST).log()).clamp_min(0).sqrt()
    return focal * slopes + principal, conics, (reach[:, None] * torch.stack([a, c], 1).sqrt()).detach(), seen[:, 2]


def _rotations(wxyz: Tensor) -> Tensor:
    w, x, y, z = functional.normalize(wxyz, dim=1, eps=1e-12).unbind(1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return torch.stack([torch.stack(row, 1) for row in rows], 1)


def _pairs(rows: Tensor, extents: Tensor, camera: Camera) -> tuple[Tensor, Tensor]:
    """Splat and pixel of every alpha >= 1/255, by pixel, then near to far. ``rows`` lie near to far."""
    size = torch.tensor([camera.width, camera.height], device=rows.device)
    first = torch.minimum((rows[:, :2] - extents).clamp_min(0).floor().long(), size)
    end = torch.minimum((rows[:, :2] + extents).clamp_min(0).clamp_max(1e6).ceil().long(), size)
    width, height = (end - first).clamp_min(0).unbind(1)
    count = width * height
    splat = torch.repeat_interleave(torch.arange(len(rows), device=rows.device), count)
    inside = torch.arange(len(splat), device=rows.device) - torch.repeat_interleave(count.cumsum(0) - count, count)
    column, row = first[splat, 0] + inside % width[splat], first[splat, 1] + inside // width[splat]
    pixel = row * camera.width + column
    seen = _alphas(rows[splat], pixel, camera.width) >= _LEAST
    pixel, order = torch.sort(pixel[seen], stable=True)
    return splat[seen][order], pixel


def _alphas(rows: Tensor, pixel: Tensor, width: int) -> Tensor:
    dx = pixel % width + 0.5 - rows[:, 0]
    dy = torch.div(pixel, width, rounding_mode="floor") + 0.5 - rows[:, 1]
    power = -0.5 * (rows[:, 2] * dx * dx + 2 * rows[:, 3] * dx * dy + rows[:, 4] * dy * dy)
    return (rows[:, 5] * power.exp()).clamp_max(_MOST)
