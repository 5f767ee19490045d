"""What can be wrong with somebody else's avatar, as one kind of error; and how much of it is read at most."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from ..wholefile import open_ordinary

MAX_FILE_BYTES = 2**29
"""Larger files are refused unread: a head of a million splats with 17 numbers each has 68 MB."""


class ForeignFormatError(ValueError):
    """A file that is no avatar this program can read: says where, what is wrong, and what to do."""

    def __init__(self, where: object, what: str, cure: str) -> None:
        super().__init__(f"{where}: {what}; {cure}")


@contextmanager
def opened(path: Path, cure: str) -> Iterator[tuple[BinaryIO, int]]:
    """An ordinary file of at most MAX_FILE_BYTES and its size. Raises ForeignFormatError with the ``cure``."""
    try:
        with open_ordinary(path) as (file, size):
            if size > MAX_FILE_BYTES:
                raise ForeignFormatError(path, f"{size} bytes are more than the {MAX_FILE_BYTES} that are read", cure)
            yield file, size
    except OSError as error:
        raise ForeignFormatError(path, f"cannot be read ({error.strerror})", cure) from error


def by_number(path: Path) -> tuple[int, str]:
    """A key for sorting: frames go by the last number in their name, so that 10 comes after 9."""
    numbers = re.findall(r"\d+", path.stem)
    return (int(numbers[-1][-18:]) if numbers else -1, path.name)
