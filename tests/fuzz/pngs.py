"""PNGs with damaged chunks whose checksums fit."""

import struct
import zlib
from random import Random

from .damage import damaged


def mutated(content: bytes, rng: Random) -> bytes:
    """One mutation: of the bytes, or of chunks."""
    if rng.random() < 0.3:
        return damaged(content, rng)
    chunks, at = [], 8
    while at + 12 <= len(content):
        length, kind = struct.unpack_from(">I4s", content, at)
        chunks.append((kind, content[at + 8 : at + 8 + length]))
        at += 12 + length
    place = rng.randrange(len(chunks))
    kind, body = chunks[place]
    match rng.randrange(4):
        case 0:
            chunks[place] = (rng.choice((b"PLTE", b"tRNS", b"acTL", b"fcTL", b"fdAT", b"iCCP", b"eXIf", b"IDAT")), body)
        case 1:
            chunks.insert(rng.randrange(len(chunks) + 1), (kind, body))
        case 2 if kind == b"IDAT":
            chunks[place] = (kind, zlib.compress(damaged(zlib.decompress(body), rng) * rng.choice((1, 1, 100))))
        case _:
            chunks[place] = (kind, damaged(body, rng))
    return content[:8] + b"".join(map(_chunk, chunks))


def _chunk(chunk: tuple[bytes, bytes]) -> bytes:
    kind, body = chunk
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
