"""How many processes share the work of a long command."""

import os

import psutil

from .errors import UsageError

MOST_JOBS = 256


def check_jobs(jobs: int | None) -> None:
    """Raises UsageError for a --jobs that cannot be."""
    if jobs is not None and not 1 <= jobs <= MOST_JOBS:
        raise UsageError(f"--jobs {jobs}: choose from 1 to {MOST_JOBS}")


def affordable_jobs(memory: int) -> int:
    """One process for each core, as far as ``memory`` bytes are free for each; one at least."""
    return max(1, min(os.cpu_count() or 1, psutil.virtual_memory().available // memory))
