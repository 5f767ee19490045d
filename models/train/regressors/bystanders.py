"""Heads of other shapes, before near and far cameras, that only turn: what a turn adds to features differs from one
person, and from one camera, to the next."""

from collections.abc import Callable, Sequence

import numpy as np

from ....render.arrays import Floats32
from ...driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES
from ...gem import Gem
from ..workers import ALONE, Advance, Workers
from .controls import Controls, controls_of
from .headshape import random_shape
from .leaks import Leaks, pose_leak
from .response import AvatarNotSeen, Sitting, measure_responses

HEADS = 48
"""So many span half of that in which strangers differ, of whom nothing was learned; three span next to nothing."""
FEWEST = 4
"""However few pictures there are of the avatar."""
PICTURES = 50
"""Of each head."""
FOV_DEG = (15.0, 45.0)
"""Fields of view, from ... to: a head fills the picture from 1.5 m or from 0.5 m."""
_SEEN = 0.5
"""In at least this share of its pictures a head has to be seen, or nothing is known of it."""
BELIEVED = {
    **dict.fromkeys(("browDownLeft", "browDownRight"), 0.4),
    **dict.fromkeys((f"eyeLook{way}{side}" for way in ("Out", "In", "Up", "Down") for side in ("Left", "Right")), 0.5),
}
"""Of what a turn adds to these scores on avatars so much is believed of people: avatars' brows were made to read well
when lowered, and theirs read so by 4 to 9 tolerances when they turn, photoreal heads by .3 to 3."""
BELIEVED_GAZE = 0.5
"""The same for gaze: a bump on a lid moves it away from the eye."""


def heads_beside(pictures: int) -> int:
    """How many heads, where an avatar is drawn in so many pictures: as much effort for the one as for the other."""
    return int(np.clip(pictures // PICTURES, FEWEST, HEADS))


def leaks_of_bystanders(
    gems: Sequence[Gem],
    seed: int,
    heads: int,
    progress: Callable[[int, int], None] = lambda done, total: None,
    workers: Workers = ALONE,
) -> Leaks:
    """Draws and reads ``heads`` heads whose splats are those of ``gems`` in turn. Raises AvatarNotSeen where the
    tracker sees none of them, WorkerLost."""
    rngs = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(1,))).spawn(heads)
    total = heads * PICTURES
    found = workers.each(
        _leak,
        [(gems[i % len(gems)], controls_of(gems[i % len(gems)]), rng) for i, rng in enumerate(rngs)],
        lambda done: progress(done, total),
    )
    known = [leak for leak in found if leak is not None]
    if not known:
        names = ", ".join(f"'{gem.name}'" for gem in gems)
        raise AvatarNotSeen(f"the face tracker finds no face in pictures of {names} at rest with the head turned")
    return Leaks(np.stack(known))


def _leak(advance: Advance, gem: Gem, controls: Controls, rng: np.random.Generator) -> Floats32 | None:
    """[TERMS, D]; None where the tracker hardly sees the head."""
    sitting = Sitting(float(rng.uniform(*FOV_DEG)), random_shape(rng))
    weights = np.zeros((PICTURES, len(controls.lower)), np.float32)
    try:
        seen = measure_responses(gem, controls, weights, rng, lambda done, total: advance(), sitting=sitting)
    except AvatarNotSeen:
        return None
    return believed(pose_leak(seen)) if len(seen) >= _SEEN * PICTURES else None


def believed(leak: Floats32) -> Floats32:
    """The leak [TERMS, D] of an avatar of another shape, as that of a person."""
    share = np.ones(DIMENSION, np.float32)
    share[BLOCKS["gaze"]] = BELIEVED_GAZE
    for name, part in BELIEVED.items():
        share[SCORES.start + SCORE_NAMES.index(name)] = part
    return leak * share
