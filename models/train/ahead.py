"""What steps of a training need of the disk, read by threads while the steps before are still at work."""

import os
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Generic, TypeVar

AHEAD = 4
"""Steps that are read in advance; so many wait in memory at most, with all their pictures."""
THREADS = min(8, max(2, (os.cpu_count() or 1) // 2))
"""A GPU waits for pictures where two threads decode them."""

What = TypeVar("What")


class Ahead(Generic[What]):
    """What is read, by the number of the step, one step after another."""

    def __init__(self, deal: Callable[[int], Callable[[], What]], last: int) -> None:
        """
        Args:
            deal: called in the caller's thread, says what a step reads: a function that is called in another one.
            last: the number of steps, beyond which nothing is read.
        """
        self._deal, self._last = deal, last
        self._threads = ThreadPoolExecutor(THREADS, "pictures")
        self._coming: dict[int, Future[What]] = {}

    def step(self, step: int) -> What:
        """Raises what reading raised."""
        for number in range(step, min(step + AHEAD, self._last)):
            if number not in self._coming:
                self._coming[number] = self._threads.submit(self._deal(number))
        return self._coming.pop(step).result()

    def close(self) -> None:
        """No more is read."""
        self._threads.shutdown(cancel_futures=True)
