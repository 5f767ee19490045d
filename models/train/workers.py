"""The same function for many arguments in several processes, of one computing thread each."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_EXCEPTION, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from types import TracebackType
from typing import Any, Concatenate, TypeVar

from .threads import one_thread

R = TypeVar("R")
Advance = Callable[[], None]
"""Tells that one more unit of work is done."""
Work = Callable[Concatenate[Advance, ...], R]
"""A function of a module, which calls ``advance`` after every unit of work."""
LOOKED_AFTER = 0.2
"""Seconds from one look at what the others have done to the next."""


class WorkerLost(RuntimeError):
    """A process that helped is gone."""


class Workers:
    """Up to ``jobs`` processes that start with the first work and stay for the next; with one job, this process alone.

    What they do must not depend on which of them does it: then nothing depends on how many there are. On an error or
    Ctrl-C they stop at their next unit of work; where this process is killed, they end.
    """

    def __init__(self, jobs: int = 1) -> None:
        self._jobs = jobs
        self._pool: _Pool | None = None

    def __enter__(self) -> "Workers":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Sends them home."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None

    def each(
        self,
        work: Work[R],
        arguments: Sequence[tuple[Any, ...]],
        progress: Callable[[int], None] = lambda done: None,
    ) -> list[R]:
        """``work(advance, *arguments)`` for each of the arguments, in their order.

        Args:
            work: what is done with them.
            arguments: these and the answers have to be something that can be pickled.
            progress: is told how many units are done.

        Raises what ``work`` raises, and WorkerLost where a process died.
        """
        if self._jobs == 1 or len(arguments) == 1:
            return self._alone(work, arguments, progress)
        try:
            return self._together(work, arguments, progress)
        except BrokenProcessPool as error:
            raise WorkerLost(
                "a process that helped is gone, perhaps for want of memory; begin again with fewer than --jobs"
                f" {self._jobs}"
            ) from error

    def _alone(
        self,
        work: Work[R],
        arguments: Sequence[tuple[Any, ...]],
        progress: Callable[[int], None],
    ) -> list[R]:
        done = 0

        def advance() -> None:
            nonlocal done
            done += 1
            progress(done)

        return [work(advance, *one) for one in arguments]

    def _together(
        self,
        work: Work[R],
        arguments: Sequence[tuple[Any, ...]],
        progress: Callable[[int], None],
    ) -> list[R]:
        if self._pool is None:
            self._pool = _Pool(self._jobs)
        futures = self._pool.submit(work, arguments)
        waiting: set[Future[R]] = set(futures)
        while waiting:
            finished, waiting = wait(waiting, LOOKED_AFTER, FIRST_EXCEPTION)
            for future in finished:
                future.result()
            progress(self._pool.done.value)
        return [future.result() for future in futures]


ALONE = Workers()
"""This process and no other."""


@contextmanager
def deaf() -> Iterator[None]:
    """Processes started in here do not hear Ctrl-C, which a terminal tells all: their parent decides."""
    here = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGINT, signal.SIG_IGN) if here else None
    try:
        yield
    finally:
        if before is not None:
            signal.signal(signal.SIGINT, before)


class _Pool:
    """Processes, and what they share with this one."""

    def __init__(self, jobs: int) -> None:
        context = multiprocessing.get_context("spawn")  # threads of numba and torch do not survive a fork
        self.done, self._halt = context.Value("q", 0), context.Value("b", 0)
        self._processes = ProcessPoolExecutor(jobs, context, _begin, (self.done, self._halt))

    def submit(self, work: Work[R], arguments: Sequence[tuple[Any, ...]]) -> list[Future[R]]:
        self.done.value = 0
        with deaf():
            return [self._processes.submit(_in_one_thread, work, *one) for one in arguments]

    def close(self) -> None:
        self._halt.value = 1
        self._processes.shutdown(cancel_futures=True)


class _Halted(Exception):
    """Nobody wants to know the answer any more."""


_shared: Any = None
"""In a worker: how many units are done, and whether to stop."""


def _begin(done: Any, halt: Any) -> None:
    global _shared
    _shared = done, halt
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A worker that waits for work would wait for ever."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _in_one_thread(work: Work[R], *arguments: Any) -> R:
    with one_thread():
        return work(_advance, *arguments)


def _advance() -> None:
    done, halt = _shared
    if halt.value:
        raise _Halted
    with done.get_lock():
        done.value += 1
