"""A U-Net in UV space whose decoder is steered by a style, as in StyleAvatar and Animatable Gaussians."""

from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional

SLOPE = 0.2
"""Of the leaky rectifier."""
WIDEST = 256
"""Channels that no level exceeds."""
STYLE = 64
"""Length of the style vector."""


class StyleUNet(nn.Module):
    """Maps to maps of the same size.

    The encoder halves the maps level by level; the mean of its last one becomes a style vector, which scales what each
    convolution of the decoder sees (StyleGAN2). Every level of the decoder adds its share to the answer at its own
    resolution. One network for all outputs, one convolution a level at most: the paper merges the networks of
    Animatable Gaussians and thins them out. There is no noise input, so the same maps give the same answer.

    The shares begin at zero, so an untrained network answers 0.
    """

    def __init__(self, inputs: int, outputs: int, width: int, levels: int) -> None:
        """
        Args:
            inputs: channels that go in.
            outputs: channels that come out.
            width: channels at full resolution; each level below has twice as many.
            levels: how often maps are halved; their sides must be multiples of 2 ** levels.
        """
        super().__init__()
        widths = [min(width << level, WIDEST) for level in range(levels + 1)]
        self.first = nn.Conv2d(inputs, widths[0], 3, padding=1)
        pairs = list(pairwise(widths))
        self.down = nn.ModuleList(nn.Conv2d(fine, coarse, 3, stride=2, padding=1) for fine, coarse in pairs)
        self.style = nn.Sequential(
            nn.Linear(widths[-1], STYLE), nn.LeakyReLU(SLOPE), nn.Linear(STYLE, STYLE), nn.LeakyReLU(SLOPE)
        )
        self.bottom = StyledConv(widths[-1], widths[-1], STYLE)
        self.narrow = nn.ModuleList(nn.Conv2d(coarse, fine, 1) for fine, coarse in reversed(pairs))
        self.up = nn.ModuleList(StyledConv(fine, fine, STYLE) for fine, _ in reversed(pairs))
        self.shares = nn.ModuleList(nn.Conv2d(channels, outputs, 1) for channels in reversed(widths))
        for parameter in self.shares.parameters():
            nn.init.zeros_(parameter)

    def forward(self, maps: Tensor) -> Tensor:
        """[B, inputs, S, S] to [B, outputs, S, S]."""
        trail = [functional.leaky_relu(self.first(maps), SLOPE)]
        for down in self.down:
            trail.append(functional.leaky_relu(down(trail[-1]), SLOPE))
        style = self.style(trail[-1].mean((2, 3)))
        here = self.bottom(trail[-1], style)
        answer = self.shares[0](here)
        for narrow, up, share, beside in zip(
            self.narrow, self.up, list(self.shares)[1:], reversed(trail[:-1]), strict=True
        ):
            # added, not put side by side: a third of the work at full resolution
            here = up(_doubled(narrow(here)) + beside, style)
            answer = _doubled(answer) + share(here)
        return answer


class StyledConv(nn.Module):
    """A 3 x 3 convolution whose input channels a style scales, and whose output keeps unit size for inputs of unit
    size (weight demodulation, StyleGAN2 equation 3)."""

    def __init__(self, inputs: int, outputs: int, style: int) -> None:
        super().__init__()
        self.conv = nn.Conv2d(inputs, outputs, 3, padding=1, bias=False)
        self.scale = nn.Linear(style, inputs)
        nn.init.ones_(self.scale.bias)
        self.bias = nn.Parameter(torch.zeros(outputs))

    def forward(self, maps: Tensor, style: Tensor) -> Tensor:
        """[B, inputs, S, S] and [B, style] to [B, outputs, S, S]."""
        scale = self.scale(style)
        # scaling the maps in place of the weights lets a batch share one convolution
        power = scale.square() @ self.conv.weight.square().sum((2, 3)).T
        # twice the power, of which the rectifier leaves half
        even = torch.rsqrt(power / 2 + 1e-8)
        maps = self.conv(maps * scale[..., None, None]) * even[..., None, None]
        return functional.leaky_relu(maps + self.bias[:, None, None], SLOPE)


def _doubled(maps: Tensor) -> Tensor:
    return functional.interpolate(maps, scale_factor=2, mode="bilinear", align_corners=False)
