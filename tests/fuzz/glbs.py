"""Binary glTF taken apart, shaken and put together again."""

import json
import struct
from random import Random

from .damage import damaged
from .trees import shaken, text_of


def mutated(content: bytes, rng: Random) -> bytes:
    """One mutation: of the bytes, of the tree, or of the buffer."""
    kind = rng.randrange(4)
    if kind == 0:
        return damaged(content, rng)
    length = int.from_bytes(content[12:16], "little")
    text, buffer = content[20 : 20 + length], content[28 + length :]
    if kind == 1:
        buffer = damaged(buffer, rng)
    else:
        text = text_of(shaken(json.loads(text), rng))
    return packed(text, buffer)


def packed(text: bytes, buffer: bytes) -> bytes:
    """A file of these two chunks."""
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body
