"""A mailbox with one slot between two threads: what is put in replaces what nobody took, and nobody ever waits."""

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Item = TypeVar("Item")


class Mailbox(Generic[Item]):
    """Holds the newest item only; what it replaced was too late to be of use, and is counted."""

    def __init__(self) -> None:
        self._filled = threading.Condition()
        self._item: Item | None = None
        self.rouse: Callable[[], None] = lambda: None
        """Called after an item was left, in the thread that left it."""
        self.dropped = 0
        """How many items were replaced before anybody took them."""

    def put(self, item: Item) -> None:
        """Leave an item, in place of the one still there."""
        with self._filled:
            self.dropped += self._item is not None
            self._item = item
            self._filled.notify()
        self.rouse()

    def take(self, timeout: float = 0.0) -> Item | None:
        """The newest item, each only once; None when none came within ``timeout`` seconds."""
        with self._filled:
            if self._item is None and timeout > 0:
                self._filled.wait_for(lambda: self._item is not None, timeout)
            item, self._item = self._item, None
            return item
