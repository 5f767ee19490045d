"""Canonical splats taken along by deformation gradients, with gradients: the twin of ``Texels.carried``."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from ....render.diff.tensors import RawTensors
from ....render.rotations import wxyz_from_matrix
from ...captures.layout import Tracked
from ...captures.texels import Texels

DISPLACEMENT_M = 0.005
"""What counts as 1 in the maps the network sees."""


@dataclass(frozen=True)
class Moment:
    """One tracked mesh as the network and the splats need it; float32 on one device."""

    displacements: Tensor
    """[1, 3, S, S] how far each texel is from where it lies at rest, in DISPLACEMENT_M; 0 where no texel is."""
    positions: Tensor
    """[N, 3] metres, the head's pose taken out."""
    gradients: Tensor
    """[N, 3, 3]."""
    turns: Tensor
    """[N, 4] unit quaternions w >= 0 of the rotations in the gradients."""
    rotation: Tensor
    """[3] the head's pose: axis times angle ..."""
    translation: Tensor
    """[3] ... and metres."""
    weights: Tensor | None = None
    """[52] ARKit weights, where the capture knows them."""

    def bytes(self) -> int:
        """Memory it takes."""
        return sum(tensor.nbytes for tensor in vars(self).values() if tensor is not None)


def moment_of(texels: Texels, tracked: Tracked, device: torch.device | str = "cpu") -> Moment:
    """A tracked mesh at the texels."""
    positions = texels.spread(tracked.vertices)
    gradients, turns = texels.moved(tracked.vertices)
    displacements = (positions - texels.spread(texels.template.vertices)).T / DISPLACEMENT_M
    maps = torch.zeros(3, texels.size**2)
    maps[:, torch.from_numpy(texels.uv_index)] = torch.from_numpy(displacements).float()
    arrays = (positions, gradients, wxyz_from_matrix(turns), tracked.rotation, tracked.translation)
    return Moment(
        maps.view(1, 3, texels.size, texels.size).to(device),
        *(torch.from_numpy(np.array(array, np.float32)).to(device) for array in arrays),
        weights=None if tracked.arkit is None else torch.from_numpy(np.array(tracked.arkit, np.float32)).to(device),
    )


def deform(canonical: RawTensors, rest: Tensor, moment: Moment) -> RawTensors:
    """Canonical splats to a moment's expression: means and covariances through the deformation gradients.

    A covariance keeps its axes, turned by the rotation in the gradient, and takes their new lengths. That rotation is
    found by Gram-Schmidt from the mesh alone, so nothing here has a singular gradient. Quaternions keep the sign of
    the canonical ones: their product with the turn's lies at most 90 degrees away on the sphere, for w >= 0 there.

    Args:
        canonical: splats around the mesh at rest, N; unit quaternions.
        rest: [N, 3] where their texels lie at rest, metres.
        moment: where the mesh is now.
    """
    offsets = (moment.gradients @ (canonical.positions - rest)[..., None])[..., 0]
    stretched = moment.gradients @ matrices(canonical.wxyz)
    lengths = stretched.square().sum(1).clamp_min(1e-12).sqrt()
    return RawTensors(
        moment.positions + offsets,
        multiplied(moment.turns, canonical.wxyz),
        canonical.log_scales + lengths.log(),
        canonical.opacity_logits,
        canonical.colors,
    )


def multiplied(left: Tensor, right: Tensor) -> Tensor:
    """Products [N, 4] of quaternions wxyz: first ``right``, then ``left``."""
    a, b, c, d = left.unbind(-1)
    w, x, y, z = right.unbind(-1)
    rows = [
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    ]
    return torch.stack(rows, -1)


def matrices(wxyz: Tensor) -> Tensor:
    """Rotation matrices [N, 3, 3] of unit quaternions [N, 4]."""
    w, x, y, z = wxyz.unbind(-1)
    entries = [
        *(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    ]
    return torch.stack(entries, -1).unflatten(-1, (3, 3))
