"""What is learned of a splat beside the texel it lies on, and in which units."""

from typing import NamedTuple

import torch
from torch import Tensor

CHANNELS = {"offset": 3, "turn": 3, "growth": 3, "opacity": 1}
"""Of the residuals, in this order."""
STEP = {"offset": 0.003, "turn": 0.15, "growth": 0.3, "opacity": 1.0}
"""What an output of 1 means while it is small: metres, radians of half the turn, log metres, logits ..."""
BOUND = {"offset": 0.025, "turn": 0.5, "growth": 1.0, "opacity": 6.0}
"""... and what no bounded output exceeds. Hair stands two centimetres off the mesh; a splat grows or shrinks by e."""


class Residuals(NamedTuple):
    """What is learned beside the texels; all zero is the bare surface."""

    offset: Tensor
    """[N, 3] metres, canonical space."""
    turn: Tensor
    """[N, 3] vector part of a quaternion whose real part is 1, in the splat's own axes."""
    growth: Tensor
    """[N, 3] of the log scales."""
    opacity: Tensor
    """[N, 1] of the logits."""

    @classmethod
    def none(cls, count: int, device: torch.device) -> "Residuals":
        """The bare surface of so many splats."""
        return cls(*(torch.zeros(count, channels, device=device) for channels in CHANNELS.values()))

    @classmethod
    def bounded(cls, values: Tensor) -> "Residuals":
        """Outputs [sum of CHANNELS, N] in units of STEP, none beyond BOUND."""
        parts = zip(CHANNELS, values.split(list(CHANNELS.values())), strict=True)
        return cls(*(BOUND[name] * torch.tanh(part.T * (STEP[name] / BOUND[name])) for name, part in parts))

    @classmethod
    def linear(cls, values: Tensor) -> "Residuals":
        """Outputs [sum of CHANNELS, N] in units of STEP, as far as they go."""
        parts = zip(CHANNELS, values.split(list(CHANNELS.values())), strict=True)
        return cls(*(part.T * STEP[name] for name, part in parts))
