"""Hands each picture to all outputs: none can hold up the window or another one."""

import time

from ...render.arrays import Image
from ..performing.performance import Pose
from .outlet import Marks, Opener, Shown
from .worker import Report, Worker


class Fan:
    """The outputs that are on, by name. Called from the window's thread; every method but ``close`` returns at once."""

    def __init__(self) -> None:
        self._workers: dict[str, Worker] = {}
        self._finishing: list[Worker] = []
        self.marks = Marks()
        """Goes with every picture from now on."""

    @property
    def listening(self) -> bool:
        """Whether any output takes pictures now."""
        return any(worker.open for worker in self._workers.values())

    def start(self, name: str, opener: Opener, depth: int = 1, once: bool = False, filing: bool = False) -> None:
        """Turn an output on; nothing happens while one of this name is on.

        Args:
            name: what the person calls it.
            opener: opens it, in the output's thread.
            depth: how many pictures may wait; the newest win.
            once: turn it off again after one picture.
            filing: it writes a file, see ``Worker``.
        """
        if self.running(name):
            return
        if (before := self._workers.get(name)) is not None:
            self._finishing.append(before)
        self._finishing = [worker for worker in self._finishing if not worker.join(0)]
        self._workers[name] = Worker(name, opener, depth, once, filing)

    def stop(self, name: str) -> None:
        """Turn an output off; it finishes what it has in its own thread. Nothing happens when it is not on."""
        if name in self._workers:
            self._workers[name].end()

    def running(self, name: str) -> bool:
        """Whether the output of this name takes pictures."""
        return name in self._workers and self._workers[name].open

    def offer(self, picture: Image, shown_at: float, pose: Pose | None = None, avatar: str = "") -> None:
        """Give all outputs a picture [H, W, 3], or [H, W, 4] with straight alpha, which may be overwritten afterwards.

        Args:
            picture: what the window shows, without panels.
            shown_at: seconds of ``time.perf_counter``.
            pose: what the avatar does in it.
            avatar: SHA-256 of the avatar's file.
        """
        listeners = [worker for worker in self._workers.values() if worker.open]
        if not listeners:
            return
        own = picture.copy()
        own.flags.writeable = False
        shown = Shown(own, shown_at, pose, avatar, self.marks)
        for worker in listeners:
            worker.offer(shown)

    def reports(self) -> tuple[Report, ...]:
        """How each output is doing; the last word of one that is off stays until it is turned on again."""
        return tuple(worker.report() for worker in self._workers.values())

    def close(self, timeout: float = 0.8) -> bool:
        """Turn all off and wait for them, at most ``timeout`` seconds together; whether all finished in time."""
        workers = self._all()
        for worker in workers:
            worker.end()
        return _joined(workers, timeout)

    def filed(self, timeout: float = 0.0) -> bool:
        """Whether after ``close`` all files are finished, or will be within ``timeout`` seconds, which are waited."""
        return _joined([worker for worker in self._all() if worker.filing], timeout)

    def _all(self) -> list[Worker]:
        return [*self._workers.values(), *self._finishing]


def _joined(workers: list[Worker], timeout: float) -> bool:
    """Whether all are finished within ``timeout`` seconds together."""
    until = time.perf_counter() + timeout
    finished = [worker.join(until - time.perf_counter()) for worker in workers]
    return all(finished)
