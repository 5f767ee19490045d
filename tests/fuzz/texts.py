"""TOML, PLY and OSC: formats whose lines and words can be exchanged."""

import json
import re
from random import Random

from .damage import damaged
from .trees import STRANGE, shaken, text_of

_WORDS = (
    b"999999999",
    b"-1",
    b"0",
    b"1e999999999",
    b"nan",
    b"[" * 5000,
    b"9" * 5000,
    b"double",
    b"list uchar int",
    b"\xff",
    b"true",
)


def mutated_json(content: bytes, rng: Random) -> bytes:
    """One mutation of a JSON text."""
    return damaged(content, rng) if rng.random() < 0.3 else text_of(shaken(json.loads(content), rng))


def mutated_lines(head: bytes, rng: Random) -> bytes:
    """One mutation of a text: its words exchanged, its lines lost, doubled or swapped."""
    lines = head.split(b"\n")
    place, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(5):
        case 0:
            del lines[place]
        case 1:
            lines[place:place] = [lines[other]] * rng.choice((1, 200))
        case 2:
            lines[place], lines[other] = lines[other], lines[place]
        case _:
            words = re.split(rb"([\s=\"]+)", lines[place])
            words[rng.randrange(len(words))] = rng.choice(
                (*_WORDS, str(rng.choice(STRANGE[:40])).encode("utf-8", "replace"))
            )
            lines[place] = b"".join(words)
    return b"\n".join(lines)


def mutated_text(content: bytes, rng: Random) -> bytes:
    """One mutation of a text file."""
    return damaged(content, rng) if rng.random() < 0.3 else mutated_lines(content, rng)


def mutated_ply(content: bytes, rng: Random) -> bytes:
    """One mutation of a PLY: of its bytes, its header or its numbers."""
    end = content.index(b"end_header\n") + len(b"end_header\n")
    match rng.randrange(3):
        case 0:
            return damaged(content, rng)
        case 1:
            return mutated_lines(content[:end], rng) + content[end:]
        case _:
            return content[:end] + damaged(content[end:], rng)
