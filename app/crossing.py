"""``evaluate --drivers``: avatars driven by people they never saw, and compared with them (Table 3 of the paper)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..models.crossing.clip import Clip
from ..models.crossing.compare import Compared, compare, relative_embeddings
from ..models.crossing.embedding import Floats, agreement
from ..models.crossing.kept import Kept
from ..models.crossing.loop import Echo, Express, echo
from ..models.crossing.mirror import Mirror, UnseenAvatar
from .casting import Avatar, Driving, expression_of, open_avatar
from .drivers import Driver
from .entrants import Entrant
from .errors import InputError, UsageError
from .evaluation.crossing import CrossingPictures
from .evaluation.crossingfigures import WORDS, Row, crossing_json, crossing_said
from .opencapture import is_run
from .progress import ProgressBar

SIZE = 384
"""Side of an avatar's picture, pixels."""
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
    clips: dict[str, Clip] = {}
    for driver in drivers:
        bar.begin(f"{driver.name}: tracking", None)
        clips[driver.name] = driver.tracked(wish.every, wish.seconds, kept)
    pictures = CrossingPictures(clips)
    rows: list[Row] = []
    notes: list[str] = []
    for entrant in columns:
        if is_run(entrant.path):
            notes.append(f"{entrant.column.name} is a run, which a face cannot drive; distill makes a .gem of it.")
            continue
        avatar = open_avatar(entrant.path)
        stage = _Stage(entrant.column.name, avatar, Mirror(avatar.gem, SIZE), wish, kept, bar)
        try:
            for driving, express in _drivings(avatar, entrant.column.name, notes):
                rows.append(_row(stage, driving, express, drivers, clips, pictures))
        except UnseenAvatar as error:
            notes.append(f"{entrant.column.name} is left out: {error}.")
    if not rows:
        raise InputError(" ".join(notes))
    figures = crossing_json(rows, drivers, clips, SIZE, wish.every, wish.seconds, notes)
    return Crossing(figures, pictures, crossing_said(figures))


@dataclass(frozen=True)
class _Stage:
    """Where an avatar is driven."""

    name: str
    avatar: Avatar
    mirror: Mirror
    wish: CrossingWish
    kept: Kept
    bar: ProgressBar


def _drivings(avatar: Avatar, name: str, notes: list[str]) -> list[tuple[Driving, Express]]:
    """What drives an avatar: its regressor, and always the baseline where it knows ARKit shapes."""
    found: list[tuple[Driving, Express]] = []
    if avatar.gem.regressor is not None:
        found.append(("learned", expression_of(avatar, "learned")))
    if avatar.gem.arkit_weights is not None:
        found.append(("baseline", expression_of(avatar, "baseline")))
    if not found:
        notes.append(f"{name} is left out: it has neither a regressor nor ARKit shapes, so no face can drive it.")
    elif len(found) == 1:
        which = "regressor: only the baseline drives it" if avatar.gem.regressor is None else "ARKit shapes: no baseline"
        notes.append(f"{name} has no {which}.")
    return found


def _row(
    stage: _Stage,
    driving: Driving,
    express: Express,
    drivers: Sequence[Driver],
    clips: Mapping[str, Clip],
    pictures: CrossingPictures,
) -> Row:
    """All drivers through one avatar by one way of driving; only figures and the pictures of the page stay."""
    compared: dict[str, Compared] = {}
    steps: list[float] = []
    embeddings: list[tuple[Floats, Floats]] = []
    for driver in drivers:
        clip = clips[driver.name]
        stage.bar.begin(f"{stage.name}, {WORDS[driving]}, {driver.name}", len(clip.readings))
        made_of = [*driver.made_of(stage.wish.every, stage.wish.seconds), stage.avatar.sha256, driving, SIZE]
        shown = stage.kept.get(
            "echo", made_of, Echo, partial(echo, clip, express, stage.mirror, progress=stage.bar.advance)
        )
        compared[driver.name] = compare(clip, shown)
        steps.append(shown.step_secs)
        if compared[driver.name].agreement is not None:
            embeddings.append(relative_embeddings(clip, shown))
        pictures.add(driver.name, stage.name, WORDS[driving], shown, compared[driver.name])
    pooled = None
    if embeddings:
        pooled = agreement(*(np.concatenate(part) for part in zip(*embeddings, strict=True)))
    return Row(stage.name, WORDS[driving], compared, pooled, float(np.median(steps)))
