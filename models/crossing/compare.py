"""A driver beside the avatar that repeats him: figures by channel, by embedding, and the frames that agree least."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64
from .channels import CHANNELS, SCORE_CHANNELS, amplitudes, correlations, moving, table, unrests
from .clip import Clip
from .embedding import Agreement, agreement
from .lips import Lips, lips
from .loop import Echo

FEWEST_SEEN = 3
"""Frames: an avatar that is seen in fewer follows nothing."""
WORST = 8
"""Frames that are shown of each driver."""
WORST_APART_SECS = 0.4
STILL_FLOORS = 3.0
"""What a driver does not do, his avatar should not do either: movement there is counted in so many floors."""


@dataclass(frozen=True)
class Likeness:
    """Figures by channel, in the order of CHANNELS, over the frames in which driver and avatar were seen."""

    correlation: Floats64
    """[channels] NaN where the driver hardly moves."""
    amplitude: Floats64
    """[channels] avatar over driver."""
    unrest: Floats64
    """[channels] the same of second differences over time, each over its range."""
    driver_std: Floats64
    """[channels]"""
    avatar_std: Floats64
    """[channels]"""


@dataclass(frozen=True)
class Worst:
    """A frame in which driver and avatar disagree."""

    frame: int
    """Place in the clip."""
    seconds: float
    channel: str | None
    """In what most; None where the tracker saw no face on the avatar."""
    driver: float
    """What the driver does there, away from his mean over the clip, in his own standard deviations ..."""
    avatar: float
    """... and the avatar, in its own; in units of STILL_FLOORS for both where the driver does not move the channel."""


@dataclass(frozen=True)
class Compared:
    """One clip and what an avatar made of it."""

    likeness: Likeness
    agreement: Agreement | None
    """None where the avatar was hardly seen."""
    lips: Lips
    driver: Floats64
    """[S, channels] over the S frames in which both were seen, relative to the own neutral ..."""
    avatar: Floats64
    """... and the avatar."""
    times: Floats64
    """[S] seconds."""
    worst: tuple[Worst, ...]
    """At most WORST, the worst first."""
    unseen: int
    """Frames in which the tracker saw no face on the avatar."""


def compare(clip: Clip, shown: Echo) -> Compared:
    """All figures of one clip."""
    enough = int(shown.seen.sum()) >= FEWEST_SEEN
    driver = table(clip.readings.only(shown.seen), clip.neutral)
    avatar = table(shown.readings, shown.neutral, portrait=True)
    return Compared(
        likeness=likeness(driver, avatar) if enough else _nothing(table(clip.readings, clip.neutral)),
        agreement=agreement(*relative_embeddings(clip, shown)) if enough else None,
        lips=lips(clip.readings.only(shown.seen), clip.neutral, shown.readings, shown.neutral),
        driver=driver,
        avatar=avatar,
        times=clip.times[shown.seen],
        worst=worst_frames(clip.times, shown.seen, driver, avatar),
        unseen=int((~shown.seen).sum()),
    )


def likeness(driver: Floats64, avatar: Floats64) -> Likeness:
    """Of two tables [F, channels] of the same frames, FEWEST_SEEN or more."""
    unrest = unrests(driver, avatar)
    return Likeness(correlations(driver, avatar), amplitudes(driver, avatar), unrest, driver.std(0), avatar.std(0))


def relative_embeddings(clip: Clip, shown: Echo) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Of driver and avatar [S, 512], in the frames in which both were seen, each relative to its own neutral."""
    return (
        clip.readings.only(shown.seen).embeddings - clip.neutral.embedding,
        shown.readings.embeddings - shown.neutral.embedding,
    )


def worst_frames(times: Floats64, seen: NDArray[np.bool_], driver: Floats64, avatar: Floats64) -> tuple[Worst, ...]:
    """The frames that disagree most in any one channel, apart in time, the worst first.

    Channels are compared by standard deviations from their own means, as correlation does; those that the driver does
    not move by STILL_FLOORS. Frames in which the avatar was not seen come before all others.

    Args:
        times: [F] seconds.
        seen: [F] whether the avatar was seen.
        driver: [S, channels] over the seen frames.
        avatar: the same.
    """
    apart = np.full(len(times), np.inf)
    channel = np.zeros(len(times), int)
    ours = theirs = np.zeros((0, len(SCORE_CHANNELS)))
    if len(driver) >= FEWEST_SEEN:
        judged = slice(len(SCORE_CHANNELS))
        ours, theirs = (_standardised(values[:, judged], moving(driver)[judged]) for values in (driver, avatar))
        difference = np.abs(ours - theirs)
        apart[seen], channel[seen] = difference.max(1), difference.argmax(1)
    row = np.cumsum(seen) - 1
    worst: list[Worst] = []
    for frame in np.argsort(-apart, kind="stable"):
        if len(worst) == WORST or apart[frame] == 0:
            break
        now = float(times[frame])
        if any(abs(now - other.seconds) < WORST_APART_SECS for other in worst):
            continue
        if np.isfinite(apart[frame]):
            at = row[frame], channel[frame]
            name, own, its = CHANNELS[channel[frame]].name, float(ours[at]), float(theirs[at])
        else:
            name, own, its = None, 0.0, 0.0
        worst.append(Worst(int(frame), now, name, own, its))
    return tuple(worst)


def _standardised(values: Floats64, moved: NDArray[np.bool_]) -> Floats64:
    """[S, channels] away from the mean; ``moved`` [channels] says which the driver moves."""
    floors = np.array([channel.floor for channel in SCORE_CHANNELS])
    scale = np.where(moved, np.maximum(values.std(0), floors / 4), STILL_FLOORS * floors)
    return (values - values.mean(0)) / scale


def _nothing(driver: Floats64) -> Likeness:
    """What an avatar that is hardly ever seen is like."""
    none = np.zeros(len(CHANNELS))
    return Likeness(np.where(moving(driver), 0.0, np.nan), none, np.full(len(CHANNELS), np.nan), driver.std(0), none)
