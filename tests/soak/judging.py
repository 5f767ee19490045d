"""What a long run must have been like."""

from statistics import median

from .loop import Soaked

MOST_GROWTH = 0.05
"""Share by which memory may be larger in the last fifth than in the second."""
SLACK_MB = 8.0
MOST_SLOWER = 1.25
LONGEST_STALL = 1.5
"""Seconds without a picture, however bad the weather: the avatar goes on breathing. Those in which a busy machine let
the program wait for a core do not count."""


def complaints(soaked: Soaked) -> list[str]:
    """One line for each promise that was not kept; none when all is well."""
    told = [f"failed: {failure}" for failure in soaked.failures]
    if not soaked.alive:
        told.append("the capture thread is dead, or does not find the face again")
    early, late = (median(_fifth(soaked.rss, part)) for part in (1, 4))
    if late > early * (1 + MOST_GROWTH) + SLACK_MB:
        told.append(f"memory grew from {early:.0f} to {late:.0f} MB")
    for name, counts in (("handles", soaked.handles), ("threads", soaked.threads)):
        first, last = (max(_fifth(counts, part)) for part in (1, 4))
        if last > first + 4:
            told.append(f"open {name} grew from {first:.0f} to {last:.0f}")
    early, late = (median(_fifth(soaked.gaps, part)) for part in (1, 4))
    if late > early * MOST_SLOWER + 0.01:
        told.append(f"pictures came every {1e3 * early:.0f} ms, and at the end every {1e3 * late:.0f} ms")
    if max(soaked.stalls) > LONGEST_STALL:
        told.append(f"nothing moved for {max(soaked.stalls):.1f} s")
    return told


def _fifth(values: list[float] | list[int], part: int) -> list[float] | list[int]:
    """One of the five parts of a run, 0 to 4."""
    size = max(1, len(values) // 5)
    return values[part * size : (part + 1) * size] or values[-1:]
