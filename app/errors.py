"""What can go wrong in a command, as exit codes and one kind of exception; every text says what, where and the cure."""

import errno
import re
from enum import IntEnum
from pathlib import Path

from ..models.brevity import brief

NO_ROOM = (
    "a disk is full: make room on the disks of your results and of gemheads, or keep the kernels that it compiles"
    " elsewhere (NUMBA_CACHE_DIR=FOLDER)"
)
_NO_WAY = (errno.EACCES, errno.EPERM, errno.ENAMETOOLONG, errno.ELOOP, errno.ENOTDIR)
_MEMORY = re.compile("out of memory|insufficient memory|(can't|cannot|unable to|failed to) allocate", re.IGNORECASE)


class ExitCode(IntEnum):
    """What the shell sees; docs/commands.md explains each to its reader."""

    OK = 0
    UNEXPECTED = 1
    USAGE = 2
    INPUT = 3
    NO_FACE = 4
    OUTPUT = 5
    ALTERED = 6
    UNSIGNED = 7
    INTERRUPTED = 130


def no_way_to(error: BaseException) -> str | None:
    """One line for a path that the system does not let anybody open, whatever for; None for all else."""
    if not isinstance(error, OSError) or error.errno not in _NO_WAY or not error.filename:
        return None
    return f"{brief(error.filename)}: cannot be opened ({error.strerror}); check the path and its permissions"


def lacks_memory(error: BaseException) -> bool:
    """Whether the memory is full: torch, OpenCV and onnxruntime each say so in errors of their own."""
    return isinstance(error, MemoryError) or bool(_MEMORY.search(str(error)))


def lacks_room(error: BaseException) -> bool:
    """Whether a disk is full, or its quota used up."""
    return isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)


class CommandError(Exception):
    """A failure the person can mend: printed as one plain line, never as a traceback."""

    code = ExitCode.UNEXPECTED


class UsageError(CommandError):
    """The command line asks for something that cannot be."""

    code = ExitCode.USAGE


class InputError(CommandError):
    """A file that was given is missing, broken, or of the wrong kind."""

    code = ExitCode.INPUT


class NoFaceError(CommandError):
    """The driver was read, and nobody is in it."""

    code = ExitCode.NO_FACE


class OutputError(CommandError):
    """The result could not be written: no permission, no space, no encoder."""

    code = ExitCode.OUTPUT


def cannot_write(path: Path, error: OSError) -> OutputError:
    """What is said where the system refuses a result."""
    return OutputError(f"{path}: cannot be written ({error.strerror}); check the folder and the space")


class TrainingExtra:
    """``with TrainingExtra("fitting"):`` around imports that need torch: InputError says what to install without it."""

    def __init__(self, what: str) -> None:
        self._what = what

    def __enter__(self) -> None: ...

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        if isinstance(error, ImportError):
            raise InputError(f"{self._what} needs {error.name}; install it: pip install 'gemheads[train]'") from error
