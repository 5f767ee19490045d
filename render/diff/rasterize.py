"""The one door to differentiable splatting: it chooses the engine and lays the picture on its background."""

import logging
from typing import Literal

import torch
from torch import Tensor

from ..camera import Camera
from . import cpu, cuda, oracle
from .tensors import GaussianTensors

EngineName = Literal["auto", "torch", "cpu", "cuda"]
_LOG = logging.getLogger(__name__)
_told: set[str] = set()


def rasterize(
    gaussians: GaussianTensors,
    camera: Camera,
    background: Tensor | None = None,
    engine: EngineName = "auto",
    world_to_camera: Tensor | None = None,
) -> Tensor:
    """The picture of ``render.reference.render_reference``, with gradients for every tensor that goes in.

    Args:
        gaussians: activated splats; those not finite, too near or too faint are left out and get gradient 0.
        camera: intrinsics, size, and where it stands unless ``world_to_camera`` says so.
        background: [3] or [H, W, 3] sRGB-encoded RGB behind the splats; None leaves the ground transparent.
        engine: ``torch`` is plain, slow, and runs in any precision on any device; ``cpu`` is float32 kernels with a
            backward pass derived by hand; ``cuda`` is gsplat, which falls back with one line in the log where it or a
            device is missing; ``auto`` follows the tensors: their device, and ``torch`` for float64.
        world_to_camera: [4, 4] in place of the camera's own, for gradients of the view (its last row has none).

    Returns:
        [H, W, 4] premultiplied RGBA, or [H, W, 3] RGB where there is a background; dtype and device of the splats.

    Raises:
        ValueError: where shapes, dtypes or devices do not agree, or ``cpu`` is asked for anything but float32.
        cpu.TooManyPairs: a ValueError, where ``cpu`` would have to remember more than fits the memory.
    """
    like = gaussians.positions
    if world_to_camera is None:
        world_to_camera = torch.as_tensor(camera.world_to_camera)
    if world_to_camera.shape != (4, 4):
        raise ValueError(f"world_to_camera must be [4, 4], got {list(world_to_camera.shape)}")
    world_to_camera = world_to_camera.to(like.device)
    chosen = _engine(engine, like)
    if chosen == "cpu":
        return cpu.render(gaussians, camera, world_to_camera, background)
    if chosen == "cuda":
        image = cuda.render(gaussians.to("cuda"), camera, world_to_camera.to("cuda", torch.float32)).to(like.device)
    else:
        image = oracle.render(gaussians, camera, world_to_camera.to(like.dtype))
    return image if background is None else over(image, background)


def over(image: Tensor, background: Tensor) -> Tensor:
    """Premultiplied RGBA [..., 4] on RGB [3] or [..., 3]: RGB [..., 3]."""
    return image[..., :3] + (1 - image[..., 3:]) * background.to(image)


def _engine(name: EngineName, like: Tensor) -> str:
    if name not in ("auto", "torch", "cpu", "cuda"):
        raise ValueError(f"engine must be auto, torch, cpu or cuda, got {name!r}")
    if name == "cpu" and (like.dtype != torch.float32 or like.device.type != "cpu"):
        raise ValueError(f"engine cpu draws float32 on the CPU, got {like.dtype} on {like.device}; take auto or torch")
    own = "cpu" if like.device.type == "cpu" and like.dtype == torch.float32 else "torch"
    if name == "cuda" or (name == "auto" and like.device.type == "cuda" and like.dtype == torch.float32):
        reason = cuda.missing()
        if reason is None:
            return "cuda"
        _tell(f"gsplat is not used ({reason}); splats are drawn by the engine '{own}'")
        return own
    return own if name == "auto" else name


def _tell(line: str) -> None:
    if line not in _told:
        _told.add(line)
        _LOG.warning(line)
