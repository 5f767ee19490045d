"""What the capture thread hands to the window: shots of a performance, and how the source is doing. Never a picture."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .performance import Pose

SourcePhase = Literal["no source", "opening", "searching", "tracking", "hold", "idle", "stalled"]


@dataclass(frozen=True)
class Observed:
    """What one picture showed of the followed face, in numbers: what coach, hints and the live neutral need."""

    features: NDArray[np.float32]
    """[D] the feature vector, nothing subtracted."""
    rotation: NDArray[np.float64]
    """[3] the head against the camera, axis and angle in radians (x pitch, y yaw, z roll)."""
    box_px: tuple[float, float, float, float]
    """Left, top, right, bottom of the face."""
    picture_size: tuple[int, int]
    """Width and height in pixels."""
    luma: float
    """Mean luma of the face, in [0, 1]."""
    surround: float
    """Mean luma of the whole picture, in [0, 1]: much brighter than the face when the light comes from behind."""
    sharpness: float
    """As ``FaceObservation.sharpness``: a blurred face is near 0."""
    presence: float
    """How sure the tracker is that it looks at a face, in (0.5, 1]."""
    faces: int
    """Faces in the picture, as last counted."""

    @property
    def is_finite(self) -> bool:
        """Whether all of it can be reckoned with."""
        return bool(np.isfinite(self.features).all() and np.isfinite(self.rotation).all())


@dataclass(frozen=True)
class Shot:
    """One moment of the performance."""

    serial: int
    """Rises by one a shot."""
    pose: Pose
    """What the avatar named by ``avatar`` does."""
    avatar: str
    """SHA-256 of the avatar file that the coefficients belong to."""
    delivered: float
    """When the source delivered the frame, in seconds of ``time.perf_counter``."""
    ready: float
    """When the pose was done, on the same clock."""
    source_secs: float
    """The source's own time."""
    sketch: NDArray[np.float32] | None = None
    """[478, 2] landmarks, x right and y down, in [0, 1] of the picture; None without a face."""
    observed: Observed | None = None
    """None without a face."""
    stages: dict[str, float] = field(default_factory=dict)
    """Seconds by stage: read (from delivered to looked at), track, express."""


@dataclass(frozen=True)
class Health:
    """How the source is doing, in words for the person in front of it."""

    phase: SourcePhase = "no source"
    message: str = ""
    """One plain sentence, empty when all is well."""
    cure: str = ""
    """What to do about it, one plain sentence."""
    frames: int = 0
    """Frames looked at since the source was chosen."""
    drops: int = 0
    """Frames that a newer one replaced before anybody looked at them."""
    rate: float = 0.0
    """Frames delivered a second, over the last two seconds."""
    source: str = ""
    """Its name, for people."""
    hints: tuple[str, ...] = ()
    """What makes the face hard to follow, each a plain sentence with its cure."""
    rejected: int = 0
    """Frames that were no pictures, and expressions with a value that is not finite; the last good one stayed."""
    neutral: str = ""
    """Which face counts as the driver's at rest, and why it was chosen; empty before there is one."""
    settled: bool = False
    """Whether that choice is final; until then it follows a provisional one."""
    pictured: bool = False
    """Whether the source shows pictures, or may when it is open: in them a neutral can be taken."""
    serial: int = 0
    """Which source this is about: rises by one with each that is chosen."""
