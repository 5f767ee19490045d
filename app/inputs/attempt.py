"""Opening a source where it may hang for ever without harm: in a thread that can be forgotten."""

import threading
from collections.abc import Callable

from .source import LiveSource, Opener

Spawn = Callable[[Callable[[], None]], None]
"""Runs something elsewhere."""


def in_thread(work: Callable[[], None]) -> None:
    """In a thread that does not keep the program from ending."""
    threading.Thread(target=work, name="opening a source", daemon=True).start()


class Attempt:
    """One try at opening."""

    def __init__(self, opener: Opener, spawn: Spawn = in_thread) -> None:
        self._opener = opener
        self._lock = threading.Lock()
        self._forgotten = False
        self._outcome: LiveSource | Exception | None = None
        spawn(self._run)

    @property
    def outcome(self) -> LiveSource | Exception | None:
        """The source, or why there is none; None while it is not known."""
        return self._outcome

    def forget(self) -> None:
        """Nobody waits any more: what is opened after all is closed again."""
        with self._lock:
            self._forgotten = True
            found, self._outcome = self._outcome, None
        _close(found)

    def _run(self) -> None:
        try:
            found: LiveSource | Exception = self._opener()
        except Exception as error:  # whatever it is, the person is told and the loop goes on
            found = error
        with self._lock:
            if not self._forgotten:
                self._outcome = found
                return
        _close(found)


def _close(found: LiveSource | Exception | None) -> None:
    if found is not None and not isinstance(found, Exception):
        found.close()
