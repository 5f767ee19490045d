"""Files that appear whole or not at all, and reading only what is an ordinary file."""

import hashlib
import os
import stat
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from io import BufferedReader
from pathlib import Path
from typing import Any

LONGEST_NAME = 255
"""Bytes, on most disks."""
_END = ".partial"


def write_whole(path: Path, parts: Iterable[Any]) -> None:
    """Writes buffers to a file beside ``path``, makes sure they are on the disk, and only then gives it that name.

    What a link stands for is written, not the link. Raises OSError; then nothing is left behind, and what was at
    ``path`` is still there.
    """
    path = behind_links(path)
    aside = path.with_name(f"{_begin(path)}{whose()}{_END}")
    try:
        with aside.open("wb") as file:
            for part in parts:
                file.write(part)
            file.flush()
            os.fsync(file.fileno())
        aside.replace(path)
    except BaseException:
        with suppress(OSError):
            aside.unlink()
        raise


def whose() -> str:
    """Tells this thread of this process from all others, in the name of what is not whole yet."""
    return f"{os.getpid()}-{threading.get_ident()}"


def partials_of(path: Path) -> list[Path]:
    """What ``write_whole`` left beside ``path`` when its process was killed."""
    path = behind_links(path)
    begin = _begin(path)
    return [file for file in path.parent.iterdir() if file.name.startswith(begin) and file.name.endswith(_END)]


def marked(path: Path, mark: str) -> Path:
    """``path`` with ``.mark`` before its suffix, which it keeps: the name of what is not finished yet.

    Where that leaves no room for its stem, it has what stands for that.
    """
    end = f".{mark}{path.suffix}"
    stem = os.fsencode(path.stem)
    room = LONGEST_NAME - len(os.fsencode(end)) - len(".")  # a point before it hides it
    return path.with_name(f"{path.stem if len(stem) <= room else hashlib.sha256(stem).hexdigest()[:32]}{end}")


def behind_links(path: Path) -> Path:
    """The file that a link stands for, whether it is there or not; any other path as it is."""
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def _begin(path: Path) -> str:
    """How the name of a file begins that is not whole yet: where its own leaves no room, with what stands for that."""
    room = LONGEST_NAME - len(f"..{2**22}-{2**64}{_END}")
    name = os.fsencode(path.name)
    return f".{path.name if len(name) <= room else hashlib.sha256(name).hexdigest()[:32]}."


def settle(path: Path) -> None:
    """Make sure that a file which somebody else wrote is on the disk. Raises OSError."""
    with path.open("r+b") as file:  # Windows settles only what may be written
        os.fsync(file.fileno())


@contextmanager
def open_ordinary(path: Path) -> Iterator[tuple[BufferedReader, int]]:
    """Opens an ordinary file for reading and gives it with its size in bytes.

    Raises OSError; for a folder, a pipe or a device too, which could block or never end.
    """
    try:
        ordinary = stat.S_ISREG(path.stat().st_mode)
    except ValueError as error:  # a null byte in the name
        raise OSError(None, str(error)) from error
    if not ordinary:
        raise OSError(None, "it is no ordinary file")
    with path.open("rb") as file:
        yield file, os.fstat(file.fileno()).st_size


def file_sha256(path: Path) -> str:
    """SHA-256 of an ordinary file in hexadecimal, read piece by piece. Raises OSError like ``open_ordinary``."""
    with open_ordinary(path) as (file, _):
        return hashlib.file_digest(file, "sha256").hexdigest()
