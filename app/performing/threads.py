"""Stages that overlap in time and keep their order: a producer that works ahead, a consumer that works behind."""

import queue
import threading
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Generic, TypeVar

import numba

Item = TypeVar("Item")
_END = object()
ROOM_SECS = 0.1
"""From one look at whether anybody still wants what is produced to the next."""


class _Box:
    """Holds ``depth`` items between two threads, of which one may hear Ctrl-C at any moment.

    That of the standard library (``queue.Queue``) waits in Python code: an interrupt between a lock and what it is
    taken for leaves it locked for ever, and both threads waiting. ``SimpleQueue`` takes and gives in one step.
    """

    def __init__(self, depth: int) -> None:
        self._items: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._room: queue.SimpleQueue[None] = queue.SimpleQueue()
        for _ in range(depth):
            self._room.put(None)

    def put(self, item: Any, seconds: float | None = None) -> bool:
        """Waits for room, at most so many seconds; whether there was any."""
        try:
            self._room.get(timeout=seconds)
        except queue.Empty:
            return False
        self._items.put(item)
        return True

    def get(self) -> Any:
        """The oldest item, once there is one."""
        item = self._items.get()
        self._room.put(None)
        return item

    def end(self) -> None:
        """Puts the mark of the end, however little room there is."""
        self._items.put(_END)


@contextmanager
def at_most(threads: int) -> Iterator[None]:
    """numba's kernels run on so many threads at most, as far as this thread calls them; one at least.

    A kernel ends when the last of its threads does. While the tracker has a core, a thread too many waits for that.
    """
    before = numba.get_num_threads()
    numba.set_num_threads(max(1, min(threads, before)))
    try:
        yield
    finally:
        numba.set_num_threads(before)


def ahead(items: Iterable[Item], depth: int = 4) -> Generator[Item, None, None]:
    """The same items in the same order, produced up to ``depth`` ahead in a thread of their own.

    An exception of the producer is raised where it would have been; a consumer that stops early stops the producer.
    """
    box = _Box(depth)
    stopped = threading.Event()

    def offer(item: Any) -> bool:
        while not stopped.is_set():
            if box.put(item, ROOM_SECS):
                return True
        return False

    def produce() -> None:
        try:
            for item in items:
                if not offer((item, None)):
                    return
            offer((_END, None))
        except BaseException as error:  # handed to the consumer, whatever it is
            offer((_END, error))

    thread = threading.Thread(target=produce, daemon=True)
    thread.start()
    try:
        while True:
            item, error = box.get()
            if error is not None:
                raise error
            if item is _END:
                return
            yield item
    finally:
        stopped.set()
        thread.join()


class Behind(Generic[Item]):
    """Calls ``consume`` for each item put, in order, in a thread of its own, at most ``depth`` behind."""

    def __init__(self, consume: Callable[[Item], None], depth: int = 4) -> None:
        self._consume = consume
        self._box = _Box(depth)
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def put(self, item: Item) -> None:
        """Hand over one item; raises what ``consume`` raised for an earlier one."""
        if self._error is not None:
            raise self._error
        self._box.put(item)

    def finish(self) -> None:
        """Wait until everything put was consumed; raises what ``consume`` raised."""
        self.abandon()
        if self._error is not None:
            raise self._error

    def abandon(self) -> None:
        """Wait until everything put was consumed, and say nothing of what went wrong: something else already did."""
        if self._thread.is_alive():
            self._box.end()
            self._thread.join()

    def _run(self) -> None:
        while (item := self._box.get()) is not _END:
            if self._error is None:  # after a failure the box is only emptied, so that put never blocks
                try:
                    self._consume(item)
                except BaseException as error:
                    self._error = error
