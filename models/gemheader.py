"""The head of an avatar's file: the safetensors header, checked before anything of the size it claims is allocated."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

MAX_HEADER_BYTES = 64 * 2**10
"""An honest header has 3 to 6 kB; what is larger is refused unread."""
MAX_FILE_BYTES = 2**30
DTYPES = {name: np.dtype(code) for name, code in {"F32": "<f4", "U32": "<u4", "F16": "<f2", "U16": "<u2"}.items()}
DTYPES |= {"I8": np.dtype(np.int8), "U8": np.dtype(np.uint8)}
"""The types of numbers that an avatar's file uses, under their safetensors names."""
FETCH_AGAIN = "get the file again, or make it again from its source"
_MAX_SIDE = 2**40
_LENGTH_BYTES = 8
_ALIGNMENT = 8


class GemFormatError(ValueError):
    """A file that is no avatar this version can use: says what is wrong, where, and what to do."""

    def __init__(self, what: str, cure: str = FETCH_AGAIN, where: str | None = None) -> None:
        super().__init__(f"{what}; {cure}" if where is None else f"{where}: {what}; {cure}")
        self.what, self.cure = what, cure

    def at(self, where: object) -> "GemFormatError":
        """The same error with the place where it happened."""
        return GemFormatError(self.what, self.cure, str(where))


@dataclass(frozen=True)
class Entry:
    """Where one tensor lies."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    start: int
    """First byte, counted from the start of the payload."""
    end: int
    """One past the last byte."""


@dataclass(frozen=True)
class Header:
    """What a safetensors file says it holds."""

    metadata: dict[str, str]
    entries: dict[str, Entry]
    """Name -> place, in the order of the file, without gaps or overlaps."""
    payload: int
    """Where the payload starts in the file."""


def read_header(file: BinaryIO, size: int) -> Header:
    """The header of an open file of ``size`` bytes. Raises GemFormatError; reads at most 64 KiB."""
    if size == 0:
        raise GemFormatError("the file is empty")
    if size > MAX_FILE_BYTES:
        raise GemFormatError(f"the file has {size} bytes, an avatar has at most {MAX_FILE_BYTES}", "give an avatar")
    length = int.from_bytes(file.read(_LENGTH_BYTES), "little")
    if size < _LENGTH_BYTES or not 2 <= length <= MAX_HEADER_BYTES:
        raise GemFormatError("this is no avatar: it does not start with a safetensors header", "give a .gem file")
    if _LENGTH_BYTES + length > size:
        raise GemFormatError(f"the file is cut off: its header has {length} bytes, the file {size}")
    if length % _ALIGNMENT:
        raise GemFormatError(f"its header has {length} bytes, which is no multiple of {_ALIGNMENT}")
    tree = read_json(file.read(length), "the header")
    metadata = tree.pop("__metadata__", {})
    if not isinstance(metadata, dict) or not all(isinstance(value, str) for value in metadata.values()):
        raise GemFormatError("__metadata__ in the header is no table of texts")
    entries = {name: _entry(name, value) for name, value in tree.items()}
    _check_places(entries, size - _LENGTH_BYTES - length)
    ordered = dict(sorted(entries.items(), key=lambda item: (item[1].start, item[1].end)))
    return Header(metadata, ordered, _LENGTH_BYTES + length)


def header_bytes(metadata: Mapping[str, str], tensors: Mapping[str, NDArray[Any]]) -> bytes:
    """The header of a file whose payload is these tensors one behind the other; the payload starts 8-aligned."""
    names = {dtype: name for name, dtype in DTYPES.items()}
    tree: dict[str, object] = {"__metadata__": dict(metadata)}
    start = 0
    for name, tensor in tensors.items():
        end = start + tensor.nbytes
        tree[name] = {"dtype": names[tensor.dtype], "shape": list(tensor.shape), "data_offsets": [start, end]}
        start = end
    text = json.dumps(tree, separators=(",", ":"), ensure_ascii=True).encode()
    text += b" " * (-len(text) % _ALIGNMENT)
    if len(text) > MAX_HEADER_BYTES:
        raise ValueError(
            f"name and origin of an avatar take {len(text)} bytes, {MAX_HEADER_BYTES} at most: shorten them"
        )
    return len(text).to_bytes(_LENGTH_BYTES, "little") + text


def read_json(text: bytes | str, what: str) -> dict[str, Any]:
    """A JSON object without duplicate keys, NaN or endless nesting. Raises GemFormatError."""
    try:
        tree = json.loads(text, object_pairs_hook=_without_duplicates, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise GemFormatError(f"{what} is not the JSON it should be ({type(error).__name__}: {error})") from error
    if not isinstance(tree, dict):
        raise GemFormatError(f"{what} is not a JSON object")
    return tree


def whole(value: object, low: int, high: int) -> bool:
    """Whether ``value`` is an integer (no bool) in low..high."""
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def _entry(name: str, value: object) -> Entry:
    if not isinstance(value, dict) or set(value) != {"dtype", "shape", "data_offsets"}:
        raise GemFormatError(f"tensor {name[:40]!r} is not described by dtype, shape and data_offsets")
    dtype, shape, offsets = value["dtype"], value["shape"], value["data_offsets"]
    if not isinstance(dtype, str) or dtype not in DTYPES:
        raise GemFormatError(f"tensor {name[:40]!r} has the type {str(dtype)[:20]!r}, which no avatar uses")
    if not isinstance(shape, list) or len(shape) > 4 or not all(whole(side, 0, _MAX_SIDE) for side in shape):
        raise GemFormatError(f"tensor {name[:40]!r} has an impossible shape")
    if not isinstance(offsets, list) or len(offsets) != 2 or not all(whole(o, 0, MAX_FILE_BYTES) for o in offsets):
        raise GemFormatError(f"tensor {name[:40]!r} lies at an impossible place")
    if offsets[1] - offsets[0] != math.prod(shape) * DTYPES[dtype].itemsize:
        raise GemFormatError(f"tensor {name[:40]!r} of shape {shape} does not fit its {offsets[1] - offsets[0]} bytes")
    return Entry(DTYPES[dtype], tuple(shape), offsets[0], offsets[1])


def _check_places(entries: Mapping[str, Entry], available: int) -> None:
    end, width = 0, _ALIGNMENT
    for name, entry in sorted(entries.items(), key=lambda item: (item[1].start, item[1].end)):
        if entry.start != end:
            raise GemFormatError(f"tensor {name[:40]!r} starts at byte {entry.start} of the payload instead of {end}")
        if entry.start < entry.end:  # an empty one lies anywhere
            if entry.dtype.itemsize > width:
                raise GemFormatError(f"tensor {name[:40]!r} of {entry.dtype} lies behind one of a narrower type")
            width = entry.dtype.itemsize
        end = entry.end
    if end != available:
        raise GemFormatError(f"the file is cut off or has grown: its tensors need {end} bytes, {available} are there")


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) != len(pairs):
        raise ValueError("a key stands twice")
    return table


def _no_constant(name: str) -> None:
    raise ValueError(f"{name} is no JSON number")
