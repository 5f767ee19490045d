"""What the header of an MP4 or MOV says of its clock, which FFmpeg does not tell."""

import struct
from pathlib import Path

from .wholefile import open_ordinary

_MOST_BYTES = 2**24
_MOST_BOXES = 64
"""Before the header, in a file that is in fragments."""
_NO_MEDIA = -1
"""Where an edit list names the time at which media begin: nothing is shown yet."""


def fragments_say_when(path: Path) -> bool:
    """Whether a file's clock begins where its first fragment says, and no edit list says that nothing is shown before.

    What is cut from a stream that is running is such; nobody means it to be late. Raises OSError.
    """
    header = _header_before_fragments(path)
    return b"mvex" in header and not _begins_empty(header)


def _header_before_fragments(path: Path) -> bytes:
    """What is in the box ``moov``; nothing where media come before it, as they cannot in fragments."""
    with open_ordinary(path) as (file, size):
        at = 0
        for _ in range(_MOST_BOXES):
            file.seek(at)
            head = file.read(16)
            if len(head) < 16:
                break
            length, kind = struct.unpack_from(">I4s", head)
            length = struct.unpack_from(">Q", head, 8)[0] if length == 1 else length or size - at
            if kind == b"moov":
                return head + file.read(min(length, _MOST_BYTES) - len(head)) if length > len(head) else b""
            if kind in (b"moof", b"mdat") or length < 8:
                break
            at += length
    return b""


def _begins_empty(header: bytes) -> bool:
    """Whether the edit list of any track begins with an edit in which nothing is shown."""
    at = -1
    while (at := header.find(b"elst", at + 1)) >= 0:
        kind = "q" if header[at + 4 : at + 5] == b"\1" else "i"
        first = struct.Struct(f">{kind.upper()}{kind}")
        if at + 12 + first.size <= len(header) and first.unpack_from(header, at + 12)[1] == _NO_MEDIA:
            return True
    return False
