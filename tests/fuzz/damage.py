"""Bytes damaged as disks, networks and attackers damage them."""

from random import Random

NUMBERS = (
    0,
    1,
    0x7F,
    0x80,
    0xFF,
    0x7FFF,
    0xFFFF,
    2**31 - 1,
    2**31,
    2**32 - 1,
    2**53,
    2**60,
    2**63 - 1,
    2**63,
    2**64 - 1,
)
"""Where readers count wrong."""
_FLOATS = (b"\0\0\xc0\x7f", b"\0\0\x80\x7f", b"\0\0\x80\xff", b"\xff\xff\x7f\x7f", b"\1\0\0\0", b"\0\0\0\x80")
"""float32: NaN, infinities, the largest, the smallest, -0."""


def damaged(content: bytes, rng: Random) -> bytes:
    """The same bytes after one to four accidents."""
    torn = bytearray(content)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        rng.choice(_ACCIDENTS)(torn, rng)
    return bytes(torn)


def _place(torn: bytearray, rng: Random) -> int:
    """Anywhere, but half of the time near the start, where headers are."""
    return rng.randrange(max(1, min(len(torn), 256) if rng.random() < 0.5 else len(torn)))


def _flip(torn: bytearray, rng: Random) -> None:
    if torn:
        torn[_place(torn, rng)] ^= 1 << rng.randrange(8)


def _overwrite(torn: bytearray, rng: Random) -> None:
    size = rng.choice((1, 2, 4, 8))
    number = rng.choice(NUMBERS) & (2 ** (8 * size) - 1)
    _put(torn, rng, number.to_bytes(size, rng.choice(("little", "big"))))


def _poison(torn: bytearray, rng: Random) -> None:
    _put(torn, rng, rng.choice(_FLOATS))


def _scribble(torn: bytearray, rng: Random) -> None:
    _put(torn, rng, rng.randbytes(rng.randint(1, 64)))


def _put(torn: bytearray, rng: Random, piece: bytes) -> None:
    start = _place(torn, rng)
    torn[start : start + len(piece)] = piece


def _cut(torn: bytearray, rng: Random) -> None:
    del torn[rng.randrange(len(torn) + 1) :]


def _remove(torn: bytearray, rng: Random) -> None:
    start = _place(torn, rng)
    del torn[start : start + rng.randint(1, 64)]


def _repeat(torn: bytearray, rng: Random) -> None:
    start = _place(torn, rng)
    piece = torn[start : start + rng.randint(1, 256)]
    torn[start:start] = piece * rng.choice((1, 2, 50))


def _append(torn: bytearray, rng: Random) -> None:
    torn += rng.randbytes(rng.randint(1, 64))


_ACCIDENTS = (_flip, _overwrite, _overwrite, _poison, _scribble, _cut, _remove, _repeat, _append)
