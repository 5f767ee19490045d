"""3D Gaussians as torch tensors: the two spaces of ``render.gaussians``, differentiable."""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor

from ..gaussians import Gaussians


class RawTensors(NamedTuple):
    """N splats in raw space, the tensors of ``RawGaussians``."""

    positions: Tensor
    """[N, 3] centres, metres."""
    wxyz: Tensor
    """[N, 4] quaternions of any length > 0."""
    log_scales: Tensor
    """[N, 3] log metres."""
    opacity_logits: Tensor
    """[N] logits of the peak opacities."""
    colors: Tensor
    """[N, 3] sRGB-encoded RGB in [0, 1]."""


@dataclass(frozen=True)
class GaussianTensors:
    """N splats in activated space, all of one dtype on one device."""

    positions: Tensor
    """[N, 3] centres, metres."""
    wxyz: Tensor
    """[N, 4] rotations, quaternions of any length > 0: engines normalise them, and the gradient knows."""
    scales: Tensor
    """[N, 3] standard deviations, metres, > 0."""
    opacities: Tensor
    """[N] peak opacities in (0, 1)."""
    colors: Tensor
    """[N, 3] sRGB-encoded RGB in [0, 1]."""

    def __post_init__(self) -> None:
        count = len(self.positions)
        wanted = {"positions": (3,), "wxyz": (4,), "scales": (3,), "opacities": (), "colors": (3,)}
        for name, shape in wanted.items():
            tensor = getattr(self, name)
            if tensor.shape != (count, *shape):
                raise ValueError(f"{name} of {count} splats must be {[count, *shape]}, got {list(tensor.shape)}")
            if tensor.dtype != self.positions.dtype or tensor.device != self.positions.device:
                raise ValueError(
                    f"{name} is {tensor.dtype} on {tensor.device}, positions are {self.positions.dtype} on"
                    f" {self.positions.device}; bring them together"
                )

    def __len__(self) -> int:
        return len(self.positions)

    def to(self, device: torch.device | str, dtype: torch.dtype | None = None) -> "GaussianTensors":
        """The same splats elsewhere; gradients flow back."""
        return GaussianTensors(*(tensor.to(device, dtype or tensor.dtype) for tensor in vars(self).values()))


def activate(raw: RawTensors) -> GaussianTensors:
    """Raw to activated space: exp of scales, sigmoid of opacities; engines normalise quaternions."""
    return GaussianTensors(raw.positions, raw.wxyz, raw.log_scales.exp(), raw.opacity_logits.sigmoid(), raw.colors)


def tensors_of(gaussians: Gaussians, dtype: torch.dtype = torch.float32) -> GaussianTensors:
    """Copies of NumPy splats as tensors on the CPU."""
    return GaussianTensors(*(torch.tensor(array, dtype=dtype) for array in vars(gaussians).values()))
