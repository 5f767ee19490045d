"""What an avatar does, frame by frame, apart from who made it do so."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .presence import Phase


@dataclass(frozen=True)
class Pose:
    """One frame of a performance: everything that drawing needs."""

    coefficients: NDArray[np.float32]
    """[coefficients] the avatar's own units."""
    turn: NDArray[np.float32]
    """[3] rotation of the head from its rest, axis and angle in radians."""
    phase: Phase = Phase.TRACKING
    faces: int = 1
    """Faces in the picture, as last counted; 0 when none is followed."""
    clamped: float = 0.0
    """``Gem.limit_share`` of the coefficients."""
    cut: bool = False
    """Whether another scene begins here."""
    translation: NDArray[np.float32] = field(default_factory=lambda: np.zeros(3, np.float32))
    """[3] metres the head is moved after it turned, as ``models.posing.pose_head`` takes it; drivers leave it 0."""
