"""Avatars are opened in a thread of their own; the window asks, and takes what came of it."""

import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import CommandError
from ..performing.casting import Avatar, expression_of, open_avatar
from ..performing.mailbox import Mailbox

_END = Path()
"""Asked for at the end."""


@dataclass(frozen=True)
class Refused:
    """A file that does not come on stage."""

    path: Path
    reason: str


class Loader:
    """Opens one avatar at a time; of several that are asked for, the last one counts."""

    def __init__(self, prepare: Callable[[Avatar], None] = lambda avatar: None, opened: Iterable[Avatar] = ()) -> None:
        """
        Args:
            prepare: what else takes its time, in the same thread, before an avatar is handed over.
            opened: avatars that somebody opened for the stage already: not read again when they are first asked for.
        """
        self._prepare = prepare
        self._opened_before = {avatar.path.resolve(): avatar for avatar in opened}
        self._wanted: Mailbox[Path] = Mailbox()
        self._ready: Mailbox[Avatar | Refused] = Mailbox()
        self.loading: Path | None = None
        """What is being opened."""
        self._thread = threading.Thread(target=self._run, name="loader", daemon=True)
        self._thread.start()

    def open(self, path: Path) -> None:
        """Ask for an avatar; returns at once."""
        self.loading = path
        self._wanted.put(path)

    def newest(self) -> Avatar | Refused | None:
        """What came of the last wish; each answer is given once, and none to a wish that another one replaced."""
        answer = self._ready.take()
        if answer is None or answer.path != self.loading:
            return None
        self.loading = None
        return answer

    def close(self) -> None:
        """End the thread, when it is through with what it opens."""
        self._wanted.put(_END)

    def _run(self) -> None:
        while (path := self._wanted.take(timeout=3600.0)) is not _END:
            if path is not None:
                self._ready.put(self._opened(path))

    def _opened(self, path: Path) -> Avatar | Refused:
        try:
            before = self._opened_before.pop(path.resolve(), None)
            avatar = replace(before, path=path) if before is not None else open_for_stage(path)
            self._prepare(avatar)
        except CommandError as error:
            return Refused(path, str(error))
        except Exception as error:  # whatever a file does to its readers, the window goes on
            return Refused(path, f"{path}: cannot be opened ({type(error).__name__}: {error})")
        return avatar


def open_for_stage(path: Path) -> Avatar:
    """Open an avatar that is to be driven. Raises InputError for a file that is none, and for a regressor that is
    broken; one that no face can drive still plays its own tracks."""
    avatar = open_avatar(path)
    if avatar.gem.regressor is not None:
        expression_of(avatar, "learned")
    return avatar
