"""Where the time goes: milliseconds by stage."""

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol


class Watch(Protocol):
    """``with watch("draw"):`` around a stage."""

    def __call__(self, stage: str) -> AbstractContextManager[None]:
        """Time one visit to ``stage``."""
        ...


class Stopwatch:
    """Adds up wall time by name; each name belongs to one thread."""

    def __init__(self) -> None:
        self._totals: dict[str, float] = {}
        self._counts: dict[str, int] = {}

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        """Time one visit to ``stage``."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self._totals[stage] = self._totals.get(stage, 0.0) + time.perf_counter() - start
            self._counts[stage] = self._counts.get(stage, 0) + 1

    def mean_ms(self) -> dict[str, float]:
        """Mean milliseconds a visit, by stage, in the order of the first visits."""
        return {stage: round(1e3 * total / self._counts[stage], 3) for stage, total in self._totals.items()}
