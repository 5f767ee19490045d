"""Which pictures each step learns from: dealt by number, so that a run can go on from any step."""

from collections import defaultdict
from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from ..captures.layout import Shot

Purpose = Literal["shots", "ground", "crop"]
"""What is left to chance in a step: its pictures, what is behind them, where the VGG term looks."""
PURPOSES = get_args(Purpose)


class Deck:
    """Moments in random order, each once before one comes again, with some of their pictures."""

    def __init__(self, shots: Sequence[Shot], hand: int, seed: int) -> None:
        """``hand`` pictures a step, or all that the moment has."""
        moments: dict[int, list[Shot]] = defaultdict(list)
        for shot in shots:
            moments[shot.timestep].append(shot)
        self._moments = [moments[timestep] for timestep in sorted(moments)]
        self._hand, self._seed = hand, seed
        self._round, self._order = -1, np.zeros(0, np.int64)

    def dealt(self, step: int) -> list[Shot]:
        """The pictures of a step, all of one moment."""
        turn, place = divmod(step, len(self._moments))
        if turn != self._round:
            self._round, self._order = (
                turn,
                np.random.default_rng([self._seed, 0, turn]).permutation(len(self._moments)),
            )
        moment = self._moments[self._order[place]]
        chosen = self.lot(step, "shots").permutation(len(moment))[: self._hand]
        return [moment[index] for index in chosen]

    def lot(self, step: int, what: Purpose) -> np.random.Generator:
        """The chance of a step: the same for the same step, whatever was before. Nothing needs to be kept of it."""
        return np.random.default_rng([self._seed, 1 + PURPOSES.index(what), step])


def spaced(shots: Sequence[Shot], count: int) -> list[Shot]:
    """So many of the shots, the middles of equal parts of the list; all where there are no more."""
    if len(shots) <= count:
        return list(shots)
    return [shots[int((part + 0.5) * len(shots) / count)] for part in range(count)]


def frontal(shots: Sequence[Shot]) -> list[Shot]:
    """Those of the camera that sees most of the face: the one most in front of the canonical head."""
    if not shots:
        return []
    ahead = {shot.camera_index: shot.camera.center[2] / np.linalg.norm(shot.camera.center) for shot in shots}
    best = max(ahead, key=ahead.__getitem__)
    return [shot for shot in shots if shot.camera_index == best]
