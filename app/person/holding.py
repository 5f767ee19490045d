"""What is held of a face that goes: what it did a moment before, for as it goes it is read worst.

A hand that covers a face, or the picture's edge that cuts it, bends what the tracker reads for some frames, of which it
is as sure as ever; then the face is gone, and the last of them would stay for as long as faces are held.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...render.arrays import Floats

BEFORE_SECS = 0.2
"""So long before it went a face is held as it was: about as long as a hand takes that rises, or a face that leaves."""
AT_ONCE_SECS = 0.05
"""A face that is missing for less, one frame or two, is held as it was last: trackers blink in the dark."""
EASE_SECS = 0.1
"""In which what was last goes over into what was before."""


@dataclass(frozen=True)
class Moment:
    """What was made of a face that was seen."""

    seconds: float
    expression: Floats
    """[coefficients] smoothed, in units of sigma from rest."""
    turn: Floats
    """[3] smoothed, of the driver's head."""
    shown_turn: Floats
    """[3] the avatar's."""


def kept(past: Sequence[Moment], now: Moment) -> tuple[Moment, ...]:
    """``past`` and ``now``, of the past no more than what may be held: one moment BEFORE_SECS ago, and those since."""
    moments = [moment for moment in past if moment.seconds < now.seconds]
    old = sum(moment.seconds <= now.seconds - BEFORE_SECS for moment in moments)
    return (*moments[max(0, old - 1) :], now)


def held(past: Sequence[Moment], missing_secs: float) -> Moment:
    """What is shown of a face that was last seen ``missing_secs`` ago; ``past`` is what ``kept`` gave, not empty."""
    before, last = past[0], past[-1]
    share = float(np.clip((missing_secs - AT_ONCE_SECS) / EASE_SECS, 0, 1))
    share = share * share * (3 - 2 * share)
    return Moment(
        last.seconds,
        last.expression + share * (before.expression - last.expression),
        last.turn + share * (before.turn - last.turn),
        last.shown_turn + share * (before.shown_turn - last.shown_turn),
    )
