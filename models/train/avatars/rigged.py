"""Mesh-rigged Gaussians with static appearance: the idea of Gaussian Avatars (Qian et al., CVPR 2024) on texels.

Theirs are bound to triangles and become more where they are needed; these are bound to texels, one each, so that the
baseline has as many splats as the CNN it stands beside.
"""

from .avatar import Avatar
from .deform import Moment
from .residuals import Residuals


class RiggedAvatar(Avatar):
    """Splats whose offset, turn, size, opacity and colour are learned once; the mesh alone moves them."""

    title = "mesh-rigged"

    def residuals(self, moment: Moment) -> Residuals:
        """The same for every moment, within the CNN's bounds."""
        del moment
        return Residuals.bounded(self.constant)
