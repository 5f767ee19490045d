"""What every live source offers to the capture thread."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ...models.arkit import NAMES
from ...models.driver.face import LEAST_SIDE, MOST_SIDE
from ..files.frames import Frame
from ..performing.performance import Pose

Kind = Literal["camera", "video", "pictures", "track", "weights"]


@dataclass(frozen=True)
class TimedFrame(Frame):
    """A picture that knows when it was delivered: what latency is measured from."""

    delivered: float = field(kw_only=True)
    """Seconds of ``time.perf_counter``."""


@dataclass(frozen=True)
class WeightsFrame:
    """One moment of a performance in ARKit weights: any avatar with an ARKit map can play it."""

    weights: NDArray[np.float32]
    """[52] in the order of ``models.arkit.NAMES``, each in [0, 1]."""
    turn: NDArray[np.float32]
    """[3] rotation of the head from its rest, axis and angle in radians."""
    seconds: float
    """The source's own time."""


@dataclass(frozen=True)
class PoseFrame:
    """One moment of a coefficient track."""

    pose: Pose
    avatar_sha256: str
    """The only avatar file to which the coefficients mean something."""
    seconds: float


Delivery = Frame | WeightsFrame | PoseFrame


def is_sound(delivery: Delivery) -> bool:
    """Whether a delivery is what it says: a picture [H, W, 3] of bytes, or numbers that are finite."""
    if isinstance(delivery, Frame):
        rgb: object = delivery.rgb
        if not isinstance(rgb, np.ndarray) or rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
            return False
        return all(LEAST_SIDE <= side <= MOST_SIDE for side in rgb.shape[:2])
    if isinstance(delivery, WeightsFrame):
        return (
            delivery.weights.shape == (len(NAMES),)
            and delivery.turn.shape == (3,)
            and bool(np.isfinite(delivery.weights).all() and np.isfinite(delivery.turn).all())
        )
    if isinstance(delivery, PoseFrame):
        pose = delivery.pose
        return all(np.isfinite(values).all() for values in (pose.coefficients, pose.turn, pose.translation))
    return False


class SourceLost(Exception):
    """A source that cannot be opened, or that went away."""

    def __init__(self, message: str, cure: str, retry: bool) -> None:
        """``message`` and ``cure`` are one plain sentence each; ``retry``: whether it may come back by itself."""
        super().__init__(message)
        self.message, self.cure, self.retry = message, cure, retry


class Transport(Protocol):
    """The buttons of what can be played: every method returns at once and may be called from any thread."""

    @property
    def playing(self) -> bool:
        """False while paused, and at the end of what does not loop."""
        ...

    @property
    def loop(self) -> bool:
        """Whether it begins again at its end."""
        ...

    @loop.setter
    def loop(self, value: bool) -> None: ...

    @property
    def position(self) -> float:
        """Seconds from the beginning."""
        ...

    @property
    def duration(self) -> float:
        """Seconds, > 0; infinity while nobody knows."""
        ...

    def play(self) -> None:
        """Go on; from the beginning when it stands at the end."""
        ...

    def pause(self) -> None:
        """Stay on this frame."""
        ...

    def step(self, frames: int) -> None:
        """Pause, and go so many frames on, or back where negative."""
        ...

    def seek(self, seconds: float) -> None:
        """Go to the frame at this time."""
        ...


class LiveSource(Protocol):
    """A source that delivers as time goes by; read by one thread."""

    @property
    def name(self) -> str:
        """For people."""
        ...

    @property
    def kind(self) -> Kind:
        """A camera that falls silent or freezes has stalled; what is played may pause."""
        ...

    @property
    def transport(self) -> Transport | None:
        """None where nothing can be played."""
        ...

    @property
    def drops(self) -> int:
        """Frames that a newer one replaced before they were read."""
        ...

    @property
    def rejected(self) -> int:
        """Deliveries that were no such thing: broken pictures, packets of garbage."""
        ...

    def read(self, timeout: float) -> Delivery | None:
        """The newest frame, each only once; None when none came within ``timeout`` seconds. Raises SourceLost."""
        ...

    def close(self) -> None:
        """Let go of it at once: never waits for a device."""
        ...


Opener = Callable[[], LiveSource]
"""Opens a source, in a thread where it may take its time. Raises SourceLost or InputError."""
