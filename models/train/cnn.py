"""The CNN avatar of the paper ("Ours Net"): a tracked mesh in, splats out."""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor, nn

from ...render.diff.tensors import RawTensors
from ..captures.texels import Texels
from .deform import Moment, deform, multiplied
from .styleunet import StyleUNet

CHANNELS = {"offset": 3, "turn": 3, "growth": 3, "opacity": 1}
"""Of the residuals, in this order."""
STEP = {"offset": 0.003, "turn": 0.15, "growth": 0.3, "opacity": 1.0}
"""What an output of 1 means while it is small: metres, radians of half the turn, log metres, logits ..."""
BOUND = {"offset": 0.025, "turn": 0.5, "growth": 1.0, "opacity": 6.0}
"""... and what no output exceeds. Hair stands two centimetres off the mesh; a splat grows or shrinks by e."""
_SURROUNDINGS_M = 0.1
"""What counts as 1 in the map of positions at rest."""


@dataclass(frozen=True)
class Architecture:
    """How large the network is."""

    size: int
    """S, texels along a side of the maps: a power of two."""
    width: int
    """Channels at full resolution."""
    levels: int
    """How often the maps are halved."""


class Residuals(NamedTuple):
    """What is learned beside the mesh, bounded; all zero is the bare mesh."""

    offset: Tensor
    """[N, 3] metres, canonical space."""
    turn: Tensor
    """[N, 3] vector part of a quaternion whose real part is 1, in the splat's own axes."""
    growth: Tensor
    """[N, 3] of the log scales."""
    opacity: Tensor
    """[N, 1] of the logits."""


class CnnAvatar(nn.Module):
    """Residuals on one splat per texel: a constant part for each texel, and what the network adds for the expression.

    Colour is one learned map. The head's pose is neither seen nor answered: expressions come out in canonical space,
    and ``torchgem.pose_head`` turns the head afterwards.
    """

    index: Tensor
    rest: Tensor
    wxyz: Tensor
    log_scales: Tensor
    opacity_logits: Tensor
    surroundings: Tensor

    def __init__(self, texels: Texels, architecture: Architecture) -> None:
        super().__init__()
        count = sum(CHANNELS.values())
        self.network = StyleUNet(6, count, architecture.width, architecture.levels)
        self.constant = nn.Parameter(torch.zeros(count, len(texels)))
        self.colors = nn.Parameter(torch.full((len(texels), 3), 0.5))
        raw = texels.splats(self.colors.detach().numpy())
        index = torch.from_numpy(texels.uv_index)
        rest = torch.from_numpy(raw.positions)
        where = torch.zeros(3, texels.size**2)
        where[:, index] = rest.T / _SURROUNDINGS_M
        for name, tensor in {
            "index": index,
            "rest": rest,
            "wxyz": torch.from_numpy(raw.wxyz),
            "log_scales": torch.from_numpy(raw.log_scales),
            "opacity_logits": torch.from_numpy(raw.opacity_logits),
            "surroundings": where.view(1, 3, texels.size, texels.size),
        }.items():
            # kept with the weights: what is learned counts from these, also where a later version makes others
            self.register_buffer(name, tensor)

    def forward(self, moment: Moment, bare: bool = False) -> tuple[RawTensors, Residuals]:
        """The splats of an expression in canonical space, and how far they are from the bare mesh; ``bare`` is it."""
        residuals = self.none() if bare else self.residuals(moment)
        return deform(self.canonical(residuals), self.rest, moment), residuals

    def residuals(self, moment: Moment) -> Residuals:
        """What the network answers to a tracked mesh, bounded."""
        maps = self.network(torch.cat([moment.displacements, self.surroundings], 1))
        values = maps[0].flatten(1)[:, self.index] + self.constant
        return Residuals(
            *(
                BOUND[name] * torch.tanh(part.T * (STEP[name] / BOUND[name]))
                for name, part in zip(CHANNELS, values.split(list(CHANNELS.values())), strict=True)
            )
        )

    def none(self) -> Residuals:
        """The bare mesh."""
        return Residuals(*(torch.zeros(len(self.rest), count, device=self.rest.device) for count in CHANNELS.values()))

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
