"""The Gaussian Eigen Model: one mean and one small linear basis per modality (equation 1 of the paper)."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..render.gaussians import RawGaussians

MODALITIES = ("position", "rotation", "scale", "opacity")
CHANNELS = {"position": 3, "rotation": 4, "scale": 3, "opacity": 1}


@dataclass(frozen=True)
class Basis:
    """One modality: x = mean + k @ components, in raw space."""

    rows: NDArray[np.float32]
    """[K + 1, N * C] the mean as row 0, then the components, most variance first: m components are one contiguous read."""
    sigma: NDArray[np.float32]
    """[K] standard deviation of each coefficient over the frames it was distilled from, > 0."""

    @property
    def mean(self) -> NDArray[np.float32]:
        """[N * C] the mean."""
        return self.rows[0]

    @property
    def components(self) -> NDArray[np.float32]:
        """[K, N * C] the components."""
        return self.rows[1:]

    def __len__(self) -> int:
        return len(self.sigma)


@dataclass(frozen=True)
class Viewing:
    """Where the avatar may be seen from, and how a portrait of it is framed."""

    target: tuple[float, float, float]
    """The middle of the head (chin to crown), metres, canonical space."""
    head_height: float
    """Chin to crown, hair included, metres."""
    yaw_limit_deg: float = 45.0
    pitch_limit_deg: float = 25.0


@dataclass(frozen=True)
class Gem:
    """An avatar. Coefficients are one flat float32 vector, the modalities one behind the other in the order of MODALITIES."""

    name: str
    bases: dict[str, Basis]
    """One Basis per modality of MODALITIES."""
    colors: NDArray[np.float32]
    """[N, 3] sRGB-encoded RGB in [0, 1]."""
    neck_weights: NDArray[np.float32]
    """[N] in [0, 1]: 1 follows the head's pose, 0 stays with the shoulders."""
    neck_pivot: NDArray[np.float32]
    """[3] the point the head turns about, metres, canonical space."""
    uv_index: NDArray[np.uint16]
    """[N, 2] column and row of each splat's texel in the avatar's UV map."""
    uv_size: int
    """Side of that map in texels."""
    viewing: Viewing
    arkit_weights: NDArray[np.float32] | None = None
    """[52, coefficients] what one unit of each ARKit weight (order of ``models.arkit.NAMES``) adds to the rest coefficients, where known."""
    rest: NDArray[np.float32] | None = None
    """[coefficients] the neutral expression; None means the mean."""
    regressor: bytes | None = None
    """ONNX graph: relative features and head rotation in, clamped coefficients out."""
    about: dict[str, str] = field(default_factory=dict)
    """author, licence, consent, source."""
