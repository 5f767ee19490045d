"""kill -9 of a command."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import psutil
from waiting import eventually

PYTHON = [sys.executable, "-m", "gemheads.app.cli"]
LONGEST = 60.0
"""Seconds that the beginning of a command is waited for."""
_BY_HAND = 1 if sys.platform == "win32" else -signal.SIGKILL


class Killed(NamedTuple):
    """How it ended."""

    in_time: bool
    """Whether it was killed before it was done."""
    children: list[psutil.Process]
    """The processes it had started."""


def killed(words: Sequence[str], begun: Callable[[], object], secs: float) -> Killed:
    """Kills ``gemheads`` with these words, so long after it has begun; one that ends in an error by itself fails."""
    with subprocess.Popen([*PYTHON, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            eventually(lambda: begun() or process.poll() is not None, LONGEST, what=f"{words[0]} to begin")
            time.sleep(secs)
            children = psutil.Process(process.pid).children(recursive=True) if process.poll() is None else []
        finally:
            process.kill()
        code = process.wait()
    assert code in (0, _BY_HAND), f"{words[0]} ended by itself, with exit code {code}"
    return Killed(code != 0, children)
