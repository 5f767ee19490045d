"""Waiting for what another thread or program will do, and no longer than a busy machine may take for it."""

import inspect
import time
from collections.abc import Callable
from typing import TypeVar

SOON = 20.0
"""So many seconds the busiest machine may take."""
Found = TypeVar("Found")


def eventually(
    condition: Callable[[], Found], seconds: float = SOON, last: Callable[[], object] | None = None, what: str = ""
) -> Found:
    """What ``condition`` gives as soon as that is true.

    After so many seconds it fails, and says in vain for ``what`` (else for the condition, as it is written), and what
    ``last`` gives then.
    """
    latest = time.monotonic() + seconds
    while not (found := condition()):
        if time.monotonic() > latest:
            there = f"; the last there was: {last()}" if last else ""
            raise AssertionError(f"waited {seconds:g} s in vain for {what or in_words(condition)}{there}")
        time.sleep(0.005)
    return found


def in_words(condition: Callable[[], object]) -> str:
    """The lines that a lambda stands in, or the name of a function."""
    name = getattr(condition, "__qualname__", repr(condition))
    if "<lambda>" not in name:
        return name
    try:
        return " ".join(inspect.getsource(condition).split())
    except OSError:
        return name
