"""The thread of one output: pictures are left in a short queue, and whoever leaves them never waits."""

import logging
import threading
import time
from collections import deque
from dataclasses import dataclass, replace
from typing import Literal

from ..errors import CommandError
from .outlet import Opener, Outlet, Shown

SenderPhase = Literal["opening", "running", "finishing", "done", "failed"]
_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Report:
    """How one output is doing."""

    name: str
    phase: SenderPhase
    text: str
    """One plain line: how far it is, what came of it, or why it failed and the cure."""
    drops: int
    """Pictures that it was too slow to take."""


class Worker:
    """Opens an outlet and feeds it; the newest pictures win, and the outlet is closed whatever happens."""

    def __init__(self, name: str, opener: Opener, depth: int, once: bool, filing: bool = False) -> None:
        """
        Args:
            name: what the person calls it.
            opener: opens the outlet, in the thread.
            depth: how many pictures may wait, at least 1.
            once: it is done with the first picture.
            filing: it writes a file: the last picture, which was shown until the end, is given once more then.
        """
        self.name, self.drops, self.filing = name, 0, filing
        self._opener, self._depth, self._once = opener, depth, once
        self._waiting: deque[Shown] = deque()
        self._last: Shown | None = None
        self._changed = threading.Condition()
        self._ending = False
        self._phase: SenderPhase = "opening"
        self._text = ""
        self._outlet: Outlet | None = None
        self._thread = threading.Thread(target=self._run, name=f"sender {name}", daemon=True)
        self._thread.start()

    @property
    def open(self) -> bool:
        """Whether it still takes pictures."""
        return not self._ending and self._phase in ("opening", "running")

    def offer(self, shown: Shown) -> None:
        """Leave a picture; the oldest that waits makes room for it."""
        with self._changed:
            if not self.open:
                return
            if len(self._waiting) == self._depth:
                self._waiting.popleft()
                self.drops += 1
            self._waiting.append(shown)
            self._last = shown
            # the picture of this moment, and no other one while it is being saved
            self._ending = self._once
            self._changed.notify()

    def end(self) -> None:
        """No more pictures; those that wait are still taken."""
        with self._changed:
            if self.filing and self._last is not None and not self._ending:
                self._waiting.append(replace(self._last, shown_at=time.perf_counter()))
            self._ending = True
            self._changed.notify()

    def join(self, timeout: float) -> bool:
        """Whether it is finished within so many seconds."""
        self._thread.join(max(0.0, timeout))
        return not self._thread.is_alive()

    def report(self) -> Report:
        """How it is doing now."""
        running = self._outlet.status if self._outlet and self._phase in ("running", "finishing") else self._text
        phase = "finishing" if self._ending and self._phase == "running" else self._phase
        return Report(self.name, phase, running, self.drops)

    def _run(self) -> None:
        failure = ""
        try:
            outlet = self._outlet = self._opener()
        except Exception as error:
            self._text, self._phase = _told(self.name, error), "failed"
            return
        self._phase = "running"
        try:
            while (shown := self._next()) is not None:
                outlet.send(shown)
        except Exception as error:
            failure = _told(self.name, error)
        try:
            outlet.close()
        except Exception as error:
            failure = failure or _told(self.name, error)
        self._text = failure or outlet.status
        self._phase = "failed" if failure else "done"

    def _next(self) -> Shown | None:
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._ending)
            return self._waiting.popleft() if self._waiting else None


def _told(name: str, error: Exception) -> str:
    if isinstance(error, CommandError):
        return str(error)
    _log.exception("%s stopped", name, exc_info=error)
    return f"the {name} stopped: {type(error).__name__}: {error}; start it again"
