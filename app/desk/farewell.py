"""What ends the window from outside, as Quit does: a system that shuts down, a terminal that is closed."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

ENDING = ("SIGTERM", "SIGHUP")
"""Windows has only the first, and sends it to nobody."""


@contextmanager
def farewell(ask: Callable[[], None]) -> Iterator[None]:
    """While inside, signals of ENDING call ``ask`` in the main thread, and end nothing; one that is ignored, as under
    nohup, stays so. For the main thread."""
    before = {}
    for name in ENDING:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            before[number] = signal.signal(number, lambda *_: ask())
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
