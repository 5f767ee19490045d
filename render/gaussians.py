"""3D Gaussians in their two spaces: raw (what PCA sees and bases span) and activated (what a picture is made of)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .rotations import normalized


@dataclass(frozen=True)
class RawGaussians:
    """N splats in raw space; any finite values are valid splats after ``activate``."""

    positions: NDArray[np.float32]
    """[N, 3] centres, metres."""
    wxyz: NDArray[np.float32]
    """[N, 4] rotations, quaternions of any length > 0."""
    log_scales: NDArray[np.float32]
    """[N, 3] logarithms of the standard deviations, log metres."""
    opacity_logits: NDArray[np.float32]
    """[N] logits of the peak opacities."""
    colors: NDArray[np.float32]
    """[N, 3] sRGB-encoded RGB in [0, 1], the same from every side."""

    def __len__(self) -> int:
        return len(self.positions)


@dataclass(frozen=True)
class Gaussians:
    """N splats in activated space."""

    positions: NDArray[np.floating]
    """[N, 3] centres, metres."""
    wxyz: NDArray[np.floating]
    """[N, 4] rotations, unit quaternions."""
    scales: NDArray[np.floating]
    """[N, 3] standard deviations, metres, > 0."""
    opacities: NDArray[np.floating]
    """[N] peak opacities in (0, 1)."""
    colors: NDArray[np.floating]
    """[N, 3] sRGB-encoded RGB in [0, 1]."""

    def __len__(self) -> int:
        return len(self.positions)


def activate(raw: RawGaussians) -> Gaussians:
    """Raw to activated space: exp of scales, unit quaternions, sigmoid of opacities."""
    with np.errstate(over="ignore"):
        return Gaussians(
            positions=raw.positions,
            wxyz=normalized(raw.wxyz),
            scales=np.exp(raw.log_scales),
            opacities=1 / (1 + np.exp(-raw.opacity_logits)),
            colors=raw.colors,
        )


def packed(raw: RawGaussians) -> RawGaussians:
    """The same splats in writable, contiguous float32 arrays; copies only what is not so already.

    Compiled code sees one type for every frame, or it would be compiled again for another.
    """
    arrays = (raw.positions, raw.wxyz, raw.log_scales, raw.opacity_logits, raw.colors)
    return RawGaussians(*(np.require(array, np.float32, ["C", "W"]) for array in arrays))
