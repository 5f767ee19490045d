"""The CNN avatar of the paper ("Ours Net"): a tracked mesh in, splats out."""

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from ...captures.texels import Texels
from .avatar import Avatar
from .deform import Moment
from .residuals import CHANNELS, Residuals
from .styleunet import StyleUNet

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


class CnnAvatar(Avatar):
    """Residuals with a constant part for each texel, and what a network over UV maps adds for the expression."""

    title = "CNN"
    index: Tensor
    surroundings: Tensor

    def __init__(self, texels: Texels, architecture: Architecture) -> None:
        super().__init__(texels)
        self.network = StyleUNet(6, sum(CHANNELS.values()), architecture.width, architecture.levels)
        index = torch.from_numpy(texels.uv_index)
        where = torch.zeros(3, texels.size**2)
        where[:, index] = self.rest.T / _SURROUNDINGS_M
        self.keep("index", index)
        self.keep("surroundings", where.view(1, 3, texels.size, texels.size))

    def groups(self) -> dict[str, list[nn.Parameter]]:
        """The network, and what every avatar learns."""
        return {"network": list(self.network.parameters()), **super().groups()}

    def residuals(self, moment: Moment) -> Residuals:
        """What the network answers to a tracked mesh, bounded."""
        maps = self.network(torch.cat([moment.displacements, self.surroundings], 1))
        return Residuals.bounded(maps[0].flatten(1)[:, self.index] + self.constant)
