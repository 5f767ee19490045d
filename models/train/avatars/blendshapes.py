"""Blendshape-linear Gaussians: a mean, and one offset of every splat for each of the 52 ARKit shapes."""

import torch
from torch import nn

from ....render.diff.tensors import RawTensors
from ...arkit import NAMES
from ...captures.layout import CaptureError
from ...captures.meshes import read_weights
from ...captures.reader import Capture
from ...captures.texels import Texels
from .avatar import Avatar
from .deform import Moment
from .residuals import CHANNELS, Residuals


class BlendshapeAvatar(Avatar):
    """Residuals that are linear in the ARKit weights of a moment; the head's pose moves them, no mesh does.

    They begin at the template at rest with every shape zero, so that how a face moves is learned from pictures alone.
    """

    title = "blendshapes"
    driven_by = "the capture's ARKit weights"

    def __init__(self, texels: Texels) -> None:
        super().__init__(texels)
        self.shapes = nn.Parameter(torch.zeros(len(NAMES), sum(CHANNELS.values()), len(texels)))

    @classmethod
    def require(cls, capture: Capture) -> None:
        """Every moment must have its ARKit weights. Raises CaptureError."""
        for path in capture.meshes.values():
            if read_weights(path, capture.template) is None:
                what = "has no ARKit weights, and nothing else drives blendshapes"
                cure = "store arkit [52] with every mesh (docs/captures.md), or train --model rigged, which needs none"
                raise CaptureError(path, what, cure)

    def groups(self) -> dict[str, list[nn.Parameter]]:
        """The shapes, and what every avatar learns."""
        return {"shapes": [self.shapes], **super().groups()}

    def residuals(self, moment: Moment) -> Residuals:
        """Mean plus weighted shapes. Raises ValueError for a moment without weights."""
        if moment.weights is None:
            raise ValueError("this moment has no ARKit weights, and nothing else drives blendshapes")
        return Residuals.linear(self.constant + torch.tensordot(moment.weights, self.shapes, 1))

    def carried(self, canonical: RawTensors, moment: Moment) -> RawTensors:
        """As they are: the shapes have moved them."""
        del moment
        return canonical
