"""What all ways to learn an avatar have in common: one splat a texel, and residuals on it."""

from typing import ClassVar

import torch
from torch import Tensor, nn

from ....render.diff.tensors import RawTensors
from ...captures.reader import Capture
from ...captures.texels import Texels
from .deform import Moment, deform, multiplied
from .residuals import CHANNELS, Residuals


class Avatar(nn.Module):
    """Splats of an expression from what was tracked of it.

    A model decides what the residuals depend on; unless it says otherwise the mesh carries the splats. Colour is one
    learned map. The head's pose is neither seen nor answered: expressions come out in canonical space, and
    ``torchgem.pose_head`` turns the head afterwards.
    """

    title: ClassVar[str]
    """In tables."""
    driven_by: ClassVar[str] = "the tracked mesh"
    """In words: where its expressions come from."""

    rest: Tensor
    wxyz: Tensor
    log_scales: Tensor
    opacity_logits: Tensor

    def __init__(self, texels: Texels) -> None:
        super().__init__()
        self.constant = nn.Parameter(torch.zeros(sum(CHANNELS.values()), len(texels)))
        self.colors = nn.Parameter(torch.full((len(texels), 3), 0.5))
        raw = texels.splats(self.colors.detach().numpy())
        self.keep("rest", torch.from_numpy(raw.positions))
        self.keep("wxyz", torch.from_numpy(raw.wxyz))
        self.keep("log_scales", torch.from_numpy(raw.log_scales))
        self.keep("opacity_logits", torch.from_numpy(raw.opacity_logits))

    def keep(self, name: str, tensor: Tensor) -> None:
        """Store a tensor with the weights: what is learned counts from it, also where a later version makes another."""
        self.register_buffer(name, tensor)

    @classmethod
    def require(cls, capture: Capture) -> None:
        """Raises CaptureError where the capture lacks what drives this model."""

    def groups(self) -> dict[str, list[nn.Parameter]]:
        """All that is learned, by the names of ``Plan.rates``."""
        return {"constant": [self.constant], "colors": [self.colors]}

    def residuals(self, moment: Moment) -> Residuals:
        """What a moment makes of the splats."""
        raise NotImplementedError

    def forward(self, moment: Moment, bare: bool = False) -> tuple[RawTensors, Residuals]:
        """The splats of an expression in canonical space, and how far from the bare surface; ``bare`` is that."""
        residuals = self.none() if bare else self.residuals(moment)
        return self.carried(self.canonical(residuals), moment), residuals

    def carried(self, canonical: RawTensors, moment: Moment) -> RawTensors:
        """Splats around the mesh at rest where the moment's mesh takes them."""
        return deform(canonical, self.rest, moment)

    def none(self) -> Residuals:
        """The bare surface."""
        return Residuals.none(len(self.rest), self.rest.device)

    def canonical(self, residuals: Residuals) -> RawTensors:
        """The splats around the mesh at rest."""
        turn = torch.cat([torch.ones_like(residuals.turn[:, :1]), residuals.turn], 1)
        return RawTensors(
            self.rest + residuals.offset,
            multiplied(self.wxyz, torch.nn.functional.normalize(turn, dim=1)),
            self.log_scales + residuals.growth,
            self.opacity_logits + residuals.opacity[:, 0],
            self.colors,
        )
