"""The pictures of each training step, read by threads while the steps before are still at work."""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor

from ...captures.layout import Shot
from ..deck import Deck
from ..synthesis.views import View
from .drawing import Stage

AHEAD = 4
"""Steps that are read in advance; so many pictures wait in memory at most, times those of a step."""
THREADS = 2


class Reader:
    """Shots and views of one step after another."""

    def __init__(self, stage: Stage, deck: Deck, last: int) -> None:
        """``last`` is the number of steps, beyond which nothing is read."""
        self._stage, self._deck, self._last = stage, deck, last
        self._threads = ThreadPoolExecutor(THREADS, "pictures")
        self._coming: dict[int, tuple[list[Shot], Future[list[View]]]] = {}

    def step(self, step: int) -> tuple[list[Shot], list[View]]:
        """What a step learns from, each view with a background of its own. Raises CaptureError."""
        for number in range(step, min(step + AHEAD, self._last)):
            if number not in self._coming:
                # dealt here: a deck serves one thread
                shots, lot = self._deck.dealt(number), self._deck.lot(number, "ground")
                grounds = [lot.uniform(0, 1, 3).tolist() for _ in shots]
                self._coming[number] = shots, self._threads.submit(self._read, shots, grounds)
        shots, views = self._coming.pop(step)
        return shots, views.result()

    def close(self) -> None:
        """No more is read."""
        self._threads.shutdown(cancel_futures=True)

    def _read(self, shots: Sequence[Shot], grounds: Sequence[Sequence[float]]) -> list[View]:
        return [self._stage.view(shot, ground) for shot, ground in zip(shots, grounds, strict=True)]
