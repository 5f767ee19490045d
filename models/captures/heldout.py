"""Pictures that judge an avatar, and those through which it may look for what it judges."""

from collections.abc import Sequence
from math import gcd

from .layout import Shot
from .reader import Capture

VIEWS = 4
"""So many cameras, spread over all, are looked through where none are named."""
HELD_OUT = ("val", "test")
"""Splits that nothing is learned from."""


def spread(cameras: Sequence[int], count: int = VIEWS) -> set[int]:
    """So many of the cameras, the middles of equal parts of the list; all where there are no more."""
    if len(cameras) <= count:
        return set(cameras)
    return {cameras[round((index + 0.5) * len(cameras) / count - 0.5)] for index in range(count)}


def judged_shots(capture: Capture, split: str, count: int | None) -> tuple[Shot, ...]:
    """So many pictures of a split, evenly over its moments, the cameras taking turns; None takes all. In order of time.

    Cameras next to each other are far from each other in turn, so that few pictures see the head from all sides, too.
    """
    moments: dict[int, list[Shot]] = {}
    for shot in sorted(capture.shots(split), key=lambda shot: (shot.timestep, shot.camera_index)):
        moments.setdefault(shot.timestep, []).append(shot)
    shots = [shot for views in moments.values() for shot in views]
    if count is None or len(shots) <= count:
        return tuple(shots)
    listed = list(moments.values())
    taken: dict[str, Shot] = {}
    for turn in range(count):
        views = listed[int((turn + 0.5) * len(listed) / count)]
        shot = views[turn * _stride(len(views)) % len(views)]
        taken[str(shot.picture)] = shot
    left = [shot for shot in shots if str(shot.picture) not in taken]  # some moments have fewer cameras than turns
    for place in range(missing := count - len(taken)):
        shot = left[int((place + 0.5) * len(left) / missing)]
        taken[str(shot.picture)] = shot
    return tuple(sorted(taken.values(), key=lambda shot: (shot.timestep, shot.camera_index)))


def viewers(capture: Capture, split: str, shot: Shot) -> tuple[Shot, ...]:
    """Pictures of the same moment from VIEWS other cameras, in which the expression of ``shot`` is looked for.

    For a held-out camera (val) they are training pictures. Where the moment was filmed by one camera alone, it is
    ``shot`` itself: what the paper does throughout. Two sets serve all cameras of a moment where there are enough.
    """
    source = capture.train if split == "val" else capture.shots(split)
    here = {other.camera_index: other for other in source if other.timestep == shot.timestep}
    first = spread(sorted(here))
    others = sorted(set(here) - {shot.camera_index})
    if not others:
        return (shot,)
    if shot.camera_index in first:
        left = sorted(set(here) - first)
        first = spread(left if len(left) >= VIEWS else others)
    return tuple(here[index] for index in sorted(first))


def _stride(count: int) -> int:
    """About the golden share of ``count``, and coprime to it: its multiples visit all, the next far from the last."""
    return min((n for n in range(1, count + 1) if gcd(n, count) == 1), key=lambda n: abs(n - 0.618 * count))
