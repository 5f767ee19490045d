"""How splats are laid out before a PCA sees them."""

from dataclasses import dataclass

import numpy as np
from gemheads.render.arrays import Floats
from gemheads.render.gaussians import RawGaussians, activate
from gemheads.render.rotations import (
    matrix_from_wxyz,
    rotvec_from_matrix,
    sign_aligned,
    wxyz_from_matrix,
    wxyz_from_rotvec,
)

Row = tuple[Floats, ...]
"""Position, rotation, scale and opacity of all splats, each one flat vector."""
LEAST_SCALE_M, LEAST_OPACITY = 1e-6, 1e-4
"""What a linear model of activated values is cut to: it may answer lengths below 0 and opacities beyond 0..1."""


@dataclass(frozen=True)
class Space:
    """A layout and the way back."""

    reference: RawGaussians
    """The neutral expression: quaternions take its signs, tangent vectors begin at its rotations."""
    activated: bool = False
    """Metres and opacities, where the product takes log metres and logits."""
    tangent: bool = False
    """Rotation vectors [3] from the reference, where the product takes quaternions with aligned signs."""

    def row(self, raw: RawGaussians) -> Row:
        """One frame."""
        scales, opacities = raw.log_scales, raw.opacity_logits
        if self.activated:
            active = activate(raw)
            scales, opacities = active.scales, active.opacities
        parts = (raw.positions, self._flat_turns(raw.wxyz), scales, opacities)
        return tuple(np.asarray(part, np.float64).ravel() for part in parts)

    def splats(self, row: Row) -> RawGaussians:
        """The frame again."""
        positions, rotation, scales, opacities = row
        scales = scales.reshape(-1, 3)
        if self.activated:
            scales = np.log(np.maximum(scales, LEAST_SCALE_M))
            shares = np.clip(opacities, LEAST_OPACITY, 1 - LEAST_OPACITY)
            opacities = np.log(shares / (1 - shares))
        parts = (positions.reshape(-1, 3), self._wxyz(rotation), scales, opacities, self.reference.colors)
        return RawGaussians(*(np.ascontiguousarray(part, np.float32) for part in parts))

    def impossible(self, row: Row) -> float:
        """Share of the splats that have a length below 0 or an opacity beyond 0..1, and so are cut."""
        if not self.activated:
            return 0.0
        scales, opacities = row[2].reshape(-1, 3), row[3]
        return float(((scales <= 0).any(1) | (opacities < 0) | (opacities > 1)).mean())

    def _flat_turns(self, wxyz: Floats) -> Floats:
        if not self.tangent:
            return sign_aligned(wxyz, self.reference.wxyz)
        return rotvec_from_matrix(self._frames.swapaxes(-1, -2) @ matrix_from_wxyz(wxyz.astype(np.float64)))

    def _wxyz(self, rotation: Floats) -> Floats:
        if not self.tangent:
            return rotation.reshape(-1, 4)
        return wxyz_from_matrix(self._frames @ matrix_from_wxyz(wxyz_from_rotvec(rotation.reshape(-1, 3))))

    @property
    def _frames(self) -> Floats:
        return matrix_from_wxyz(self.reference.wxyz.astype(np.float64))
