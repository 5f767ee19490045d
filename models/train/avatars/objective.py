"""What a learned avatar is judged by: equation 2, with more weight where people look, and two regularisers."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from ..losses import SSIM_SHARE, ssim
from ..perceptual import Perceptual
from .plan import Plan
from .residuals import STEP, Residuals

TERMS = ("l1", "dssim", "vgg", "offset", "growth")


@dataclass(frozen=True)
class Objective:
    """Terms of a loss by the plan's weights."""

    plan: Plan
    perceptual: Perceptual | None
    """None leaves the VGG term out."""

    def of_picture(self, image: Tensor, target: Tensor, focus: Tensor, step: int, lot: np.random.Generator) -> Tensor:
        """[3] L1, D-SSIM and VGG of pictures [H, W, 3]; ``focus`` [H, W] in [0, 1] is where people look."""
        weights = 1 + self.plan.focus * focus
        l1 = ((image - target).abs().mean(-1) * weights).sum() / weights.sum()
        return torch.stack([l1, 1 - ssim(image, target), self._vgg(image, target, step, lot)])

    def of_residuals(self, residuals: Residuals) -> Tensor:
        """[2] mean squares of offsets and of growth, in units of STEP."""
        return torch.stack(
            [
                (residuals.offset / STEP["offset"]).square().mean(),
                (residuals.growth / STEP["growth"]).square().mean(),
            ]
        )

    def total(self, terms: Tensor) -> Tensor:
        """The loss of all terms [5] in the order of TERMS."""
        plan = self.plan
        weights = [1 - SSIM_SHARE, SSIM_SHARE, plan.perceptual, plan.offset_weight, plan.growth_weight]
        return terms @ terms.new_tensor(weights)

    def _vgg(self, image: Tensor, target: Tensor, step: int, lot: np.random.Generator) -> Tensor:
        if self.perceptual is None or step % self.plan.perceptual_every:
            return image.new_zeros(())
        height, width = image.shape[:2]
        side = self.plan.perceptual_side
        if side is not None and side < min(height, width):
            top, left = (int(lot.integers(0, length - side + 1)) for length in (height, width))
            image, target = (x[top : top + side, left : left + side] for x in (image, target))
        seen = self.perceptual.feature_loss(image.permute(2, 0, 1)[None], target.permute(2, 0, 1)[None])
        return self.plan.perceptual_every * seen
