"""The avatar in torch: differentiable twins of ``Gem.compose`` and ``posing.pose_head``.

In float32 on the CPU they run the kernels of those two, and derivatives of them by hand.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ....render.diff.tensors import RawTensors
from ...gem import CHANNELS, MODALITIES, Basis, Gem
from .turning import Turning


@dataclass(frozen=True)
class TorchGem:
    """Equation 1 and the head's pose for tensors. On the CPU the bases share the avatar's memory."""

    bases: Mapping[str, Basis]
    """The avatar's own."""
    rows: dict[str, Tensor]
    """Modality -> [K + 1, N * C], the mean as row 0."""
    colors: Tensor
    """[N, 3]."""
    neck_weights: Tensor
    """[N]."""
    neck_pivot: Tensor
    """[3]."""
    sigma: Tensor
    """[coefficients]."""

    @classmethod
    def of(cls, gem: Gem, device: str | torch.device = "cpu", dtype: torch.dtype = torch.float32) -> "TorchGem":
        """The avatar on a device, without gradients of its own."""

        def tensor(array: NDArray[np.float32]) -> Tensor:
            return torch.from_numpy(array).to(device, dtype)

        return cls(
            gem.bases,
            {name: tensor(gem.bases[name].rows) for name in MODALITIES},
            tensor(gem.colors),
            tensor(gem.neck_weights),
            tensor(gem.neck_pivot),
            tensor(gem.sigma),
        )

    def compose(self, coefficients: Tensor) -> RawTensors:
        """Equation 1: the splats of coefficients [coefficients]."""
        parts = torch.split(coefficients, [len(self.rows[name]) - 1 for name in MODALITIES])
        values = [
            self._blended(name, part).view(-1, CHANNELS[name]) for name, part in zip(MODALITIES, parts, strict=True)
        ]
        return RawTensors(values[0], values[1], values[2], values[3][:, 0], self.colors)

    def _blended(self, name: str, part: Tensor) -> Tensor:
        rows = self.rows[name]
        if _plain(rows):
            return Blending.apply(part, self.bases[name])  # type: ignore[no-any-return]
        return torch.addmv(rows[0], rows[1:].T, part)

    def posed(self, raw: RawTensors, rotvec: Tensor, translation: Tensor) -> RawTensors:
        """The splats with the head turned about the neck and moved; see ``pose_head``."""
        return pose_head(raw, self.neck_weights, self.neck_pivot, rotvec, translation)


def pose_head(raw: RawTensors, neck_weights: Tensor, pivot: Tensor, rotvec: Tensor, translation: Tensor) -> RawTensors:
    """``models.posing.pose_head`` with gradients.

    Args:
        raw: canonical splats.
        neck_weights: [N] share of the pose in [0, 1]; a share w turns by w times the angle.
        pivot: [3] metres.
        rotvec: [3] radians; the gradient is right at rest, too.
        translation: [3] metres.
    """
    if _plain(raw.positions) and not (neck_weights.requires_grad or pivot.requires_grad):
        positions, wxyz = Turning.apply(raw.positions, raw.wxyz, neck_weights, pivot, rotvec, translation)  # pyright: ignore[reportGeneralTypeIssues]
        return raw._replace(positions=positions, wxyz=wxyz)
    half = 0.5 * neck_weights * torch.linalg.vector_norm(rotvec)
    w = half.cos()
    x, y, z = (0.5 * neck_weights[:, None] * torch.sinc(half / torch.pi)[:, None] * rotvec).unbind(1)
    axis = torch.stack([x, y, z], 1)
    arm = raw.positions - pivot
    swing = torch.linalg.cross(axis, arm)
    moved = arm + 2 * (w[:, None] * swing + torch.linalg.cross(axis, swing)) + pivot
    a, b, c, d = raw.wxyz.unbind(1)
    turned = [
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    ]
    return raw._replace(positions=moved + neck_weights[:, None] * translation, wxyz=torch.stack(turned, 1))


def _plain(tensor: Tensor) -> bool:
    return tensor.device.type == "cpu" and tensor.dtype == torch.float32


class Blending(torch.autograd.Function):
    """Coefficients [K] of a basis -> [N * C], and back. float32 on the CPU."""

    @staticmethod
    def forward(ctx: Any, *inputs: Any) -> Tensor:
        """Equation 1."""
        coefficients, ctx.basis = inputs
        blended = torch.empty(ctx.basis.rows.shape[1])
        ctx.basis.compose(coefficients.detach().contiguous().numpy(), blended.numpy())
        return blended

    @staticmethod
    def backward(ctx: Any, *grad_outputs: Any) -> Any:
        """Of the coefficients."""
        return torch.from_numpy(ctx.basis.correlate(grad_outputs[0].contiguous().numpy())), None
