"""Teaches an avatar anew how its head turns, and leaves what it answers to faces as it is."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...driver.regressor import Regressor
from ...gem import Gem
from ...gemfile import load_gem
from ..workers import Workers
from .bystanders import heads_beside, leaks_of_bystanders
from .controls import controls_of
from .export_turns import with_turns
from .footage import read_footage
from .rehearsal import rehearse, remembered
from .response import PORTRAIT
from .strangers import crowd
from .train_regressor import FEWEST_OF_STRANGERS, Progress, person_of, pictures_of
from .turns import PORTRAITS, Turns, learned_turns

FACES = 4
"""Invented people have the faces of an avatar's pictures; a quarter of those that a regressor learns from do where
people are only answered, and a quarter of the steps of what is learned of them."""


def train_turns(
    avatar: Path,
    *,
    companions: Sequence[Path] = (),
    videos: Sequence[Path] = (),
    pictures: int = 4000,
    steps: int = 9000,
    seed: int = 0,
    progress: Progress = lambda stage, done, total: None,
    jobs: int = 1,
) -> tuple[Gem, Turns]:
    """Teaches ``avatar``, which has a regressor, how its head turns; gives the avatar, and how well that is known.

    Args as of ``train_regressor``.

    Raises:
        GemFormatError: for a file that is no avatar.
        RegressorError: where it has no regressor of use, or one that training did not write.
        AvatarNotSeen: where the tracker finds no face in the avatar's picture.
        WorkerLost: where one of the processes is gone.
    """
    gem, others = load_gem(avatar), [load_gem(path) for path in companions]
    regressor, controls, rng = Regressor.of(gem), controls_of(gem), np.random.default_rng(seed)
    footage = read_footage(videos, lambda done, total: progress("videos", done, total))
    faces, brief = max(FEWEST_OF_STRANGERS, pictures // FACES), max(1, steps // 3 // FACES)
    with Workers(jobs) as workers:
        seen = [
            pictures_of(one, faces, seed, lambda done, total: progress("strangers", done, total), workers)
            for one in (gem, *others)
        ]
        leaks = leaks_of_bystanders(
            [gem, *others],
            seed,
            heads_beside(faces),
            lambda done, total: progress("turning heads", done, total),
            workers,
        )
        cast = [person_of(one, brief, seed)[0] for one in seen]
        audience = crowd(cast, leaks, footage, max(1, int(pictures * PORTRAITS)), rng)
        answers = remembered(regressor, controls, audience)
        portraits = rehearse(
            gem,
            controls,
            answers,
            audience,
            rng,
            lambda done, total: progress("portraits", done, total),
            workers,
            PORTRAIT,
        )
        turns = learned_turns(portraits, steps, seed, workers)
    assert gem.regressor is not None
    taught = replace(gem, regressor=with_turns(gem.regressor, turns.poses))
    Regressor.of(taught)
    return taught, turns
