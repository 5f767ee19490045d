"""Walking a protobuf message without its schema: enough to read the face geometry and to look into an ONNX graph."""

from collections.abc import Iterator

VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5
"""Wire types: how a field is written."""
_MAX_TAG = 2**32 - 1
"""Other readers cut larger ones off, and find a field of another number there."""


def fields(message: bytes | memoryview) -> Iterator[tuple[int, int, int | memoryview]]:
    """(field number, wire type, value) of each field in order: an int for VARINT, the bytes (no copy) for all others.

    Raises ValueError when the message is truncated or not protobuf.
    """
    view, at = memoryview(message), 0
    while at < len(view):
        tag, at = _varint(view, at)
        number, wire = tag >> 3, tag & 7
        if number == 0 or tag > _MAX_TAG:
            raise ValueError(f"not a protobuf message: field {number} before byte {at}")
        if wire == VARINT:
            value, at = _varint(view, at)
            yield number, wire, value
            continue
        if wire == BYTES:
            size, at = _varint(view, at)
        elif wire in (FIXED32, FIXED64):
            size = 4 if wire == FIXED32 else 8
        else:
            raise ValueError(f"not a protobuf message: wire type {wire} at byte {at}")
        if at + size > len(view):
            raise ValueError(f"a protobuf field ends {at + size - len(view)} bytes behind the message")
        yield number, wire, view[at : at + size]
        at += size


def packed(content: memoryview) -> Iterator[int]:
    """The varints of a packed field. Raises ValueError when the last one is cut off."""
    at = 0
    while at < len(content):
        number, at = _varint(content, at)
        yield number


def text(value: int | memoryview) -> str:
    """A string field. Raises ValueError when the field is not one."""
    if isinstance(value, int):
        raise ValueError("a protobuf string was expected, found a number")
    return bytes(value).decode("utf-8")


def message(value: int | memoryview) -> memoryview:
    """A field that holds a message. Raises ValueError when it does not."""
    if isinstance(value, int):
        raise ValueError("a protobuf message was expected, found a number")
    return value


def _varint(view: memoryview, at: int) -> tuple[int, int]:
    """The number that starts at byte ``at``, and the byte behind it."""
    value = shift = 0
    while True:
        if at >= len(view) or shift > 63:
            raise ValueError(f"a protobuf number is cut off at byte {at}")
        byte = view[at]
        value |= (byte & 127) << shift
        at, shift = at + 1, shift + 7
        if byte < 128:
            if value >= 2**64:
                raise ValueError(f"a protobuf number has more than 64 bits before byte {at}")
            return value, at
