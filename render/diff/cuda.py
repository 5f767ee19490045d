"""gsplat on an NVIDIA GPU, told to draw the picture of the other engines."""

from functools import cache

import torch
from torch import Tensor

from ..camera import Camera
from ..projection import ALPHA_MAX, DILATION, NEAR
from .tensors import GaussianTensors


@cache
def missing() -> str | None:
    """Why gsplat cannot draw here, or None where it can; the first call draws one splat to know."""
    if not torch.cuda.is_available():
        return "no CUDA device"
    try:
        one = GaussianTensors(*(torch.ones(1, *shape, device="cuda") for shape in ((3,), (4,), (3,), (), (3,))))
        render(one, Camera(8, 8, 4, 4, 8, 8, torch.eye(4).numpy()), torch.eye(4, device="cuda"))
    except Exception as error:  # it compiles itself at its first call, so anything may go wrong
        return f"{type(error).__name__}: {str(error).strip().splitlines()[0] if str(error).strip() else 'no reason'}"
    return None


def render(gaussians: GaussianTensors, camera: Camera, world_to_camera: Tensor) -> Tensor:
    """[H, W, 4] premultiplied RGBA of float32 splats on a CUDA device.

    gsplat caps alpha higher than ALPHA_MAX, so the opacities are capped before it sees them: where one is above 0.99,
    the flanks of that splat are up to 1 % fainter than in the other engines.
    """
    from gsplat import rasterization

    like = gaussians.positions
    intrinsics = [[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]]
    colors, alphas, _ = rasterization(
        gaussians.positions,
        gaussians.wxyz,
        gaussians.scales,
        gaussians.opacities.clamp_max(float(ALPHA_MAX)),
        gaussians.colors,
        world_to_camera[None],
        like.new_tensor(intrinsics)[None],
        camera.width,
        camera.height,
        near_plane=float(NEAR),
        eps2d=float(DILATION),
        packed=False,
        rasterize_mode="classic",
    )
    return torch.cat([colors[0], alphas[0]], -1)
