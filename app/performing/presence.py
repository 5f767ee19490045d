"""Whether somebody is there to be followed, and how much of them the avatar shows: pure, over presence and time."""

from dataclasses import dataclass, replace
from enum import Enum

HOLD_SECS = 0.4
"""A face missing for less than this is a blink of the tracker: its expression stays (``person.holding``)."""
TO_REST_SECS = 0.6
TO_FACE_SECS = 0.25


class Phase(Enum):
    """What the avatar is doing."""

    SEARCHING = 0
    """Nobody has been seen yet: at rest, idle."""
    TRACKING = 1
    """Follows the face."""
    HOLD = 2
    """The face went a moment ago: keeps its expression."""
    IDLE = 3
    """The face is gone: eases to rest and idles."""


@dataclass(frozen=True)
class Attention:
    """What the state machine remembers."""

    phase: Phase = Phase.SEARCHING
    missing_secs: float = 0.0
    """Time since a face was last seen."""
    follow: float = 0.0
    """0 the avatar is at rest, 1 it shows the driver; moves linearly in time."""
    started: bool = False
    """Whether any frame came before."""

    @property
    def gain(self) -> float:
        """``follow`` eased at both ends (smoothstep), in [0, 1]: the weight of the driver's expression and pose."""
        return self.follow * self.follow * (3 - 2 * self.follow)


def update(before: Attention, face_seen: bool, dt: float) -> Attention:
    """The state after a frame that came ``dt`` seconds after the one before.

    A face in the first frame of all is followed at once: there is nothing to ease from.
    Raises ValueError for a negative or non-finite ``dt``.
    """
    if not 0 <= dt < float("inf"):
        raise ValueError(f"time must not run backwards: dt = {dt} s; sort the frames by their timestamps")
    if face_seen:
        follow = min(1.0, before.follow + dt / TO_FACE_SECS) if before.started else 1.0
        return Attention(Phase.TRACKING, 0.0, follow, started=True)
    if before.phase is Phase.SEARCHING:
        return replace(before, started=True)
    missing = before.missing_secs + dt
    if missing < HOLD_SECS:
        return Attention(Phase.HOLD, missing, before.follow, started=True)
    # Only the part of dt that lies beyond the hold eases: the result does not depend on the frame rate.
    easing = min(dt, missing - HOLD_SECS)
    return Attention(Phase.IDLE, missing, max(0.0, before.follow - easing / TO_REST_SECS), started=True)
