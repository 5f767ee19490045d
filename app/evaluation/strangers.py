"""``evaluate --drivers``: avatars driven by people they never saw, and compared with them (Table 3 of the paper)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.crossing.compare import Compared, compare, relative_embeddings
from ...models.crossing.embedding import agreement
from ...models.crossing.kept import Kept
from ...models.crossing.loop import Echo, echo
from ...models.crossing.mirror import UnseenAvatar
from ...models.crossing.pace import paces
from ...models.crossing.poseleak import Turned
from ...render.arrays import Floats
from ..errors import InputError, UsageError
from ..progress import ProgressBar
from .crossingfigures import Row, crossing_json, crossing_said
from .drivers import Driver, Tracked
from .entrants import Entrant
from .report.crossingpictures import CrossingPictures
from .robustness import robustness, turning_heads
from .trials import SIZE, WORDS, Trial, trials

MOST_EVERY, MOST_SECONDS = 1000, 3600.0
FOLDER = "crossing"
"""In the folder with what is not done again."""


@dataclass(frozen=True)
class CrossingWish:
    """What the command line asks for."""

    drivers: tuple[str, ...] = ()
    """Videos, pictures or folders of them."""
    every: int = 3
    """Each N-th frame is taken."""
    seconds: float = 30.0
    """Of each clip."""


@dataclass(frozen=True)
class Crossing:
    """What was found."""

    figures: dict[str, Any]
    """What report.json holds of it."""
    shown: CrossingPictures
    said: list[str]
    """Lines for the terminal."""


def check_crossing(wish: CrossingWish) -> None:
    """Raises UsageError for what cannot be."""
    if not 1 <= wish.every <= MOST_EVERY:
        raise UsageError(f"--every {wish.every}: choose from 1 to {MOST_EVERY}")
    if not 1 <= wish.seconds <= MOST_SECONDS:
        raise UsageError(f"--seconds {wish.seconds:g}: choose from 1 to {MOST_SECONDS:g}")


def cross(
    drivers: Sequence[Driver], columns: Sequence[Entrant], wish: CrossingWish, folder: Path, bar: ProgressBar
) -> Crossing:
    """Lets every driver drive every avatar, by its regressor and by the baseline that learned nothing.

    Raises InputError where nothing drives any avatar, NoFaceError for a driver without a face, OSError.
    """
    kept = Kept(folder / FOLDER)
    clips: list[Tracked] = []
    for driver in drivers:
        bar.begin(f"{driver.name}: tracking", None)
        clips.append(driver.tracked(wish.every, wish.seconds, kept))
    pictures = CrossingPictures({tracked.name: tracked.clip for tracked in clips})
    rows: list[Row] = []
    notes = [_full(tracked) for tracked in clips if tracked.clip.full]
    for entrant in columns:
        try:
            tried = trials(entrant, notes)
            if tried:
                bar.begin(f"{entrant.column.name}: turning the head", None)
                heads = turning_heads(entrant, kept)
                found = [_row(trial, clips, heads, pictures, kept, bar) for trial in tried]
                speeds = paces(clips[0].clip, [trial.express for trial in tried], tried[0].mirror)
                rows += [replace(row, pace=pace) for row, pace in zip(found, speeds, strict=True)]
        except UnseenAvatar as error:
            notes.append(f"{entrant.column.name} is left out: {error}.")
    if not rows:
        raise InputError(" ".join(notes))
    figures = crossing_json(rows, clips, SIZE, wish.every, wish.seconds, notes)
    return Crossing(figures, pictures, crossing_said(figures))


def _full(tracked: Tracked) -> str:
    """What the reader has to know of a clip that goes on behind what is kept of it."""
    clip = tracked.clip
    return (
        f"Of {tracked.name} the first {len(clip.times):,} frames with a face are taken, {clip.seconds:.1f} s: no more"
        " are kept; a larger --every reaches farther."
    )


def _row(
    trial: Trial,
    clips: Sequence[Tracked],
    heads: Mapping[str, Turned],
    pictures: CrossingPictures,
    kept: Kept,
    bar: ProgressBar,
) -> Row:
    """All drivers through one avatar by one way of driving; only figures and the pictures of the page stay."""
    who = f"{trial.avatar}, {WORDS[trial.driving]}"

    def begin(what: str, parts: int) -> Callable[[], None]:
        bar.begin(f"{who}, {what}", parts)
        return bar.advance

    compared: dict[str, Compared] = {}
    coefficients: list[NDArray[np.float32]] = []
    embeddings: list[tuple[Floats, Floats]] = []
    for tracked in clips:
        clip = tracked.clip
        advance = begin(tracked.name, len(clip.readings))
        made = partial(echo, clip, trial.express, trial.mirror, progress=advance)
        shown = kept.get("echo", [*tracked.made_of, *trial.made_of], Echo, made)
        found = compare(clip, shown)
        compared[tracked.name] = found
        coefficients.append(shown.coefficients)
        if found.agreement is not None:
            embeddings.append(relative_embeddings(clip, shown))
        pictures.add(tracked.name, trial.avatar, WORDS[trial.driving], shown, found)
    pooled = agreement(*(np.concatenate(part) for part in zip(*embeddings, strict=True))) if embeddings else None
    steady = robustness(trial, clips, coefficients, heads, kept, begin)
    return Row(trial.avatar, WORDS[trial.driving], compared, pooled, steady)
