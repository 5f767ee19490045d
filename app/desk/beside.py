"""One piece of work at a time beside the window's thread: it never waits for it."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Generic, TypeVar

Result = TypeVar("Result")


class Beside(Generic[Result]):
    """Does what it is given in a thread of its own, or here and now where it must; for one thread to ask."""

    def __init__(self, name: str) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._begun: Future[Result] | None = None
        self._work: Callable[[], Result] | None = None
        self.rouse: Callable[[], None] = lambda: None
        """Called when a piece of work is done, in the thread that did it."""

    @property
    def free(self) -> bool:
        """Whether the next piece can begin: the last one's result was taken."""
        return self._begun is None

    def begin(self, work: Callable[[], Result], here: bool) -> None:
        """Begin a piece of work while ``free``; ``here``: in this thread, before this returns."""
        assert self._begun is None
        self._work = work
        self._begun = Future() if here else self._pool.submit(work)
        if here:
            self._begun.set_result(work())
        self._begun.add_done_callback(lambda _: self.rouse())

    def result(self) -> Result | None:
        """What came of it, once; None before that.

        What failed in the other thread is done again in this one: there an engine may fall to another, or raise.
        """
        begun, work = self._begun, self._work
        if begun is None or work is None or not begun.done():
            return None
        self._begun = self._work = None
        return begun.result() if begun.exception() is None else work()

    def close(self) -> None:
        """Wait until nothing is being done any more."""
        self._pool.shutdown()
