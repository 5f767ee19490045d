"""A result is one run's at a time: what it writes is locked, and the system lets go of that however the run ends."""

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import OutputError, cannot_write

_HELD = (errno.EAGAIN, errno.EACCES, errno.EWOULDBLOCK, errno.EDEADLK)
_BEYOND = 2**62
"""Where Windows locks a byte: others cannot read what is locked, and there nothing is."""


class TakenError(OutputError):
    """Somebody else has this result, or writes it."""


def open_claimed(path: str | os.PathLike[str], flags: int) -> int:
    """A descriptor of a file that is emptied, as an ``opener`` gives it, and this run's until it is closed.

    Raises TakenError where another run has it, and OSError.
    """
    while True:
        descriptor = os.open(path, flags & ~os.O_TRUNC, 0o666)
        try:
            if not _locked(descriptor):
                raise TakenError(f"{path}: another run is writing it; wait for that, or choose another name")
            if _is_at(path, descriptor):
                os.ftruncate(descriptor, 0)
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)  # the run that had it gave it another name meanwhile


@contextmanager
def claimed_folder(folder: Path) -> Iterator[None]:
    """A folder, made where it is missing, that no other run may write into meanwhile; Windows locks none.

    Raises TakenError where another run has it, and OutputError.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = None if sys.platform == "win32" else os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise cannot_write(folder, error) from error
    try:
        if descriptor is not None and not _locked(descriptor):
            raise TakenError(f"{folder}: another run is writing into it; wait for that, or choose another folder")
        yield
    finally:
        if descriptor is not None:
            os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Whether nobody else has it; on disks that know no locks nobody can tell, and everybody may."""
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(descriptor, _BEYOND, os.SEEK_SET)
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            os.lseek(descriptor, 0, os.SEEK_SET)
        else:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno not in _HELD
    return True


def _is_at(path: str | os.PathLike[str], descriptor: int) -> bool:
    """Whether this open file still has this name; on Windows it cannot lose it."""
    try:
        return sys.platform == "win32" or os.path.samestat(os.stat(path), os.fstat(descriptor))
    except FileNotFoundError:
        return False
