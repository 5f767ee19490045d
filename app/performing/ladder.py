"""What to give up when the machine is too slow, in which order, and when to take it back: pure, over frame times."""

from dataclasses import dataclass, replace

BUDGET_MS = 33.0
"""A frame of the window, all of it."""
SLOW_SECS = 1.0
"""So long over budget before a rung is taken down."""
SPARE = 0.7
"""A frame time below this part of the budget leaves room for the rung above."""
SPARE_SECS = 5.0
"""So long with room before a rung is tried upwards; doubles each time the rung above proves too slow ..."""
MOST_SPARE_SECS = 80.0
"""... to no more than this."""
PROBATION_SECS = 10.0
"""A rung that is left again within this time of climbing to it was too slow."""
SETTLE_SECS = 0.3
"""Time constant of the mean frame time: one slow frame is no slow machine."""


@dataclass(frozen=True)
class Quality:
    """How much work a frame is."""

    components: int
    """Components a modality."""
    scale: float = 1.0
    """Side of the drawn picture in sides of the shown one, in (0, 1]."""
    detector_every: int = 1
    """Every so manieth picture of the camera is looked at."""


RUNGS = (
    Quality(1_000_000),
    Quality(30),
    Quality(10),
    Quality(10, 0.75),
    Quality(10, 0.5),
    Quality(10, 0.5, 2),
)
"""From the best to the cheapest."""


@dataclass(frozen=True)
class Ladder:
    """Where on the ladder the machine stands."""

    rung: int = 0
    """Index into RUNGS."""
    mean_ms: float = 0.0
    slow_secs: float = 0.0
    """How long the mean has been over budget."""
    spare_secs: float = 0.0
    """How long it has left room for more."""
    patience_secs: float = SPARE_SECS
    """How long it must leave room before the rung above is tried."""
    since_climb: float = PROBATION_SECS
    """Seconds since the last rung upwards."""


def quality(ladder: Ladder, wanted: Quality) -> Quality:
    """What to draw: what the person wants, as far as the rung allows."""
    rung = RUNGS[ladder.rung]
    return Quality(
        min(wanted.components, rung.components),
        min(wanted.scale, rung.scale),
        max(wanted.detector_every, rung.detector_every),
    )


def said(given: Quality, wanted: Quality) -> str:
    """What was taken from what the person wants, one plain sentence; empty when nothing was."""
    parts = []
    if given.components < wanted.components:
        parts.append(f"{given.components} components")
    if given.scale < wanted.scale:
        parts.append(f"drawn at {given.scale:.0%} of its size")
    if given.detector_every > wanted.detector_every:
        parts.append(f"one picture of the camera in {given.detector_every} is looked at")
    return f"This machine is slow: {', '.join(parts)}." if parts else ""


def update(ladder: Ladder, frame_ms: float, dt: float, wanted: Quality, budget_ms: float = BUDGET_MS) -> Ladder:
    """The ladder after a frame.

    Args:
        ladder: before it.
        frame_ms: what the work of the frame took, without waiting for the screen.
        dt: seconds since the frame before.
        wanted: what the person chose: a rung that takes nothing from it is passed over.
        budget_ms: what a frame may take.
    """
    share = dt / (dt + SETTLE_SECS) if ladder.mean_ms else 1.0
    mean = ladder.mean_ms + share * (frame_ms - ladder.mean_ms)
    after = replace(
        ladder,
        mean_ms=mean,
        slow_secs=ladder.slow_secs + dt if mean > budget_ms else 0.0,
        spare_secs=ladder.spare_secs + dt if mean < SPARE * budget_ms else 0.0,
        since_climb=ladder.since_climb + dt,
    )
    if after.slow_secs >= SLOW_SECS:
        return _down(after, wanted)
    if after.rung and after.spare_secs >= after.patience_secs:
        return _moved(after, _next(after, wanted, -1), since_climb=0.0)
    return after


def _down(ladder: Ladder, wanted: Quality) -> Ladder:
    """A rung that was tried and failed is tried later the next time; one that held for long is believed again."""
    failed = ladder.since_climb < PROBATION_SECS
    patience = min(MOST_SPARE_SECS, 2 * ladder.patience_secs) if failed else SPARE_SECS
    return replace(_moved(ladder, _next(ladder, wanted, +1), PROBATION_SECS), patience_secs=patience)


def _moved(ladder: Ladder, rung: int, since_climb: float) -> Ladder:
    """The mean begins anew: it was that of another rung."""
    return replace(ladder, rung=rung, mean_ms=0.0, slow_secs=0.0, spare_secs=0.0, since_climb=since_climb)


def _next(ladder: Ladder, wanted: Quality, way: int) -> int:
    """The next rung in this direction that changes the picture, or the end of the ladder."""
    now, rung = quality(ladder, wanted), ladder.rung
    while 0 <= rung + way < len(RUNGS):
        rung += way
        if quality(replace(ladder, rung=rung), wanted) != now:
            break
    if way < 0:  # of rungs that are alike, the topmost: nothing is said of what is not taken away
        while rung and quality(replace(ladder, rung=rung - 1), wanted) == quality(replace(ladder, rung=rung), wanted):
            rung -= 1
    return rung
