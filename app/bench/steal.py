"""How much of the cores' time the host of a virtual machine gave to others while something was measured."""

import os
import time

import psutil


class Steal:
    """Counts from when it was made."""

    def __init__(self) -> None:
        self._began, self._before = time.perf_counter(), _stolen_secs()

    def percent(self) -> float | None:
        """Of all cores' time since, 0 to 100; None where the system does not say (only Linux does)."""
        now, wall = _stolen_secs(), time.perf_counter() - self._began
        if now is None or self._before is None or wall <= 0:
            return None
        return min(100.0, 100.0 * (now - self._before) / (wall * (os.cpu_count() or 1)))


def told(percent: float | None) -> str:
    """What a bench says of it in a line."""
    if percent is None:
        return "the system does not say whether a host gave the cores to others"
    return f"the host gave {percent:.1f} % of the cores' time to others"


def _stolen_secs() -> float | None:
    return getattr(psutil.cpu_times(), "steal", None)
