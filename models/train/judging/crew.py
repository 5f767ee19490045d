"""Several processes that judge pictures, one moment at a time each; only the process that started them writes anything.

Orders and answers go through pipes. A worker whose pipe ends, because its parent has no more to do or was killed, ends.
"""

import multiprocessing
import pickle
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Any

from ...captures.reader import Capture
from ...captures.standin import StandIn
from ..workers import WorkerLost, deaf
from .contestants import Contestant
from .evaluate import Moment, judged
from .judge import Judge
from .ledger import Record

Opens = Callable[[Capture], Contestant]
"""Makes a contestant ready; has to be something that can be pickled."""
End = Any
"""Of a pipe: a Connection, on Windows a PipeConnection."""
PATIENCE = 5.0
"""Seconds that a worker has to end by itself."""


@dataclass(frozen=True)
class Order:
    """What a worker is asked to do."""

    avatar: str
    """Tells contestants apart: the one of the order before is used again."""
    opens: Opens
    moment: Moment


@dataclass(frozen=True)
class Failure:
    """What came instead of an answer."""

    error: Exception


@dataclass(frozen=True)
class _Worker:
    process: BaseProcess
    orders: End
    answers: End


class Crew:
    """Up to ``jobs`` processes of one thread each. They start with the first avatar and stay for the next ones.

    Each holds one avatar, one moment and the network of LPIPS in memory.
    """

    def __init__(self, jobs: int, capture: Capture, judge: Callable[[], Judge]) -> None:
        """``judge`` makes each worker its own, and has to be something that can be pickled."""
        self._jobs, self._capture, self._judge = jobs, capture, judge
        self._workers: list[_Worker] = []

    def __enter__(self) -> "Crew":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Sends them home; at once where something went wrong."""
        for worker in self._workers:
            worker.orders.close()
            if error is not None:
                worker.process.kill()
        for worker in self._workers:
            worker.process.join(PATIENCE)
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()
            worker.answers.close()
            worker.process.close()
        self._workers.clear()

    def judging(self, avatar: str, opens: Opens) -> "Shared":
        """These processes as whoever judges one avatar; ``avatar`` tells it apart from the others."""
        return Shared(self, avatar, opens)

    def records(self, avatar: str, opens: Opens, moments: Sequence[Moment]) -> Iterator[tuple[str, Record]]:
        """See ``evaluate.Judging``. Raises what a worker raised, and WorkerLost where one died."""
        waiting = deque(moments)
        self._start(min(self._jobs, len(moments)))
        busy: dict[End, _Worker] = {}

        def employ(worker: _Worker) -> None:
            if waiting:
                worker.orders.send(Order(avatar, opens, waiting.popleft()))
                busy[worker.answers] = worker

        try:
            for worker in self._workers:
                employ(worker)
            while busy:
                for ready in wait(list(busy)):
                    answer = busy[ready].answers.recv()
                    if isinstance(answer, Failure):
                        raise answer.error
                    if answer is None:
                        employ(busy.pop(ready))
                    else:
                        yield answer
        except (EOFError, ConnectionError) as error:
            raise WorkerLost(
                "a process that judged pictures is gone, perhaps for want of memory; what is judged is kept,"
                f" go on with fewer than --jobs {self._jobs}"
            ) from error

    def _start(self, count: int) -> None:
        context = multiprocessing.get_context("spawn")  # threads of numba and torch do not survive a fork
        while len(self._workers) < count:
            order_end, orders = context.Pipe(duplex=False)
            answers, answer_end = context.Pipe(duplex=False)
            process = context.Process(
                target=_work, args=(order_end, answer_end, self._capture, self._judge), daemon=True
            )
            with deaf():
                process.start()
            # else a worker's pipe would not end with its parent, nor the parent's with the worker
            order_end.close()
            answer_end.close()
            self._workers.append(_Worker(process, orders, answers))


@dataclass(frozen=True)
class Shared:
    """A crew that judges one avatar."""

    crew: Crew
    avatar: str
    opens: Opens

    def records(self, moments: Sequence[Moment]) -> Iterator[tuple[str, Record]]:
        """See ``evaluate.Judging``; in the order in which they are done."""
        return self.crew.records(self.avatar, self.opens, moments)


def _work(orders: End, answers: End, capture: Capture, judge: Callable[[], Judge]) -> None:
    standin = StandIn(capture)
    network: Judge | None = None
    acting: tuple[str, Contestant] | None = None
    while True:
        try:
            order = orders.recv()
        except EOFError:
            return
        try:
            network = network or judge()
            if acting is None or acting[0] != order.avatar:
                acting = order.avatar, order.opens(capture)
            for pair in judged(acting[1], standin, network, order.moment):
                answers.send(pair)
            answers.send(None)
        except BrokenPipeError:
            return
        except Exception as error:  # whatever it is, the parent has to tell it
            answers.send(Failure(_portable(error)))


def _portable(error: Exception) -> Exception:
    """The error, or its text where it does not survive the way."""
    try:
        copy = pickle.loads(pickle.dumps(error))
    except Exception:  # its constructor wants what a pickle does not keep
        return RuntimeError(f"{type(error).__name__}: {error}")
    return copy if isinstance(copy, type(error)) else RuntimeError(str(error))
