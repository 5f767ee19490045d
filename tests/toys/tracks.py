"""A track of three moments of which no two are alike."""

from fractions import Fraction

import numpy as np
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.presence import Phase
from gemheads.app.performing.tracks import Track

_RNG = np.random.default_rng(1)


def _normal(count: int) -> np.ndarray:
    return _RNG.normal(size=count).astype(np.float32)


TRACK = Track(
    avatar="tiny",
    avatar_sha256="ab" * 32,
    time_base=Fraction(1, 30000),
    rate=Fraction(30000, 1001),
    pts=np.array([7, 1008, 2009]),
    poses=tuple(
        Pose(_normal(5), _normal(3), phase, 1, 0.25, cut, _normal(3))
        for phase, cut in ((Phase.SEARCHING, False), (Phase.TRACKING, True), (Phase.HOLD, False))
    ),
)
