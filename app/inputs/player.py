"""Playing what is there as a whole: pictures, coefficient tracks, weights; each moment at its time."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .source import Delivery, Kind
from .transport import Playhead

Deliver = Callable[[int, float], Delivery]
"""The moment of an index and of a time in seconds."""
_EARLY_SECS = 1e-4
"""A frame is due this much before its time: a clock's rounding must not hold it back by one read."""
STILL_SECS = 0.2
"""How often a single picture is looked at again."""


class Player:
    """A live source over moments with known times."""

    drops = 0
    """Moments passed over because nobody read in time."""
    rejected = 0
    """Moments that could not be read."""

    def __init__(
        self, name: str, kind: Kind, times: NDArray[np.float64], deliver: Deliver, clock: Callable[[], float]
    ) -> None:
        """``times`` [F] rise, in seconds; the first counts as the beginning."""
        self.name = name
        self.kind: Kind = kind
        self._times, self._deliver = times - times[0], deliver
        last = float(np.median(np.diff(times))) if len(times) > 1 else STILL_SECS
        self.transport = Playhead(float(self._times[-1]) + last, last, clock=clock)
        self._shown, self._jumps = -1, -1

    def read(self, timeout: float) -> Delivery | None:
        """The moment that is due now; None while the one before lasts, and while paused."""
        found = self._due()
        if found is None and timeout > 0:
            self.transport.wait(min(timeout, self._until_next()))
            found = self._due()
        return found

    def close(self) -> None:
        """Nothing is held open."""

    def _due(self) -> Delivery | None:
        position = self.transport.position
        index = max(0, int(np.searchsorted(self._times, position + _EARLY_SECS, side="right")) - 1)
        if index == self._shown and self.transport.jumps == self._jumps:
            return None
        if self.transport.jumps == self._jumps:
            self.drops += max(0, index - self._shown - 1)
        self._shown, self._jumps = index, self.transport.jumps
        try:
            return self._deliver(index, float(self._times[index]))
        except InputError:  # one broken picture does not end the show
            self.rejected += 1
            return None

    def _until_next(self) -> float:
        if not self.transport.playing:
            return float("inf")
        after = self._shown + 1
        due = self._times[after] if after < len(self._times) else self.transport.duration
        return max(0.0, float(due) - self.transport.position)
