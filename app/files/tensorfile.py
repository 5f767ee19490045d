"""safetensors files of numbers and words that nobody vouches for: tracks, performances, neutrals."""

import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...models.wholefile import open_ordinary

Tensors = dict[str, NDArray[np.generic]]
MAX_HEADER_BYTES = 64 * 2**10
"""An honest header has some hundred bytes."""
_LENGTH_BYTES = 8
_RATIO = re.compile(r"[0-9]{1,10}(/[0-9]{1,10})?")
"""FFmpeg's have up to ten digits: average rates of phone videos, and times in nanoseconds."""


def is_tensor_file(path: Path) -> bool:
    """Whether an ordinary file begins as these do, whatever its name; it may still be broken."""
    try:
        with open_ordinary(path) as (file, _):
            start = file.read(_LENGTH_BYTES + 1)
    except OSError:
        return False
    return start[_LENGTH_BYTES:] == b"{" and int.from_bytes(start[:_LENGTH_BYTES], "little") <= MAX_HEADER_BYTES


def read_tensor_file(path: Path, most_bytes: int) -> tuple[dict[str, str], Tensors]:
    """Metadata and tensors of an ordinary file of at most ``most_bytes``; what they mean is for the caller to check.

    Raises OSError where it cannot be read, ValueError for a file that is larger or of another kind.
    """
    from safetensors import SafetensorError
    from safetensors.numpy import load

    with open_ordinary(path) as (file, size):
        if size > most_bytes:
            raise ValueError(f"larger than {most_bytes >> 20} MB")
        # whole, and not mapped: a file that is cut off while it is mapped ends the program
        content = file.read(most_bytes)
    try:
        length = int.from_bytes(content[:_LENGTH_BYTES], "little")
        if length > MAX_HEADER_BYTES:
            raise ValueError(f"a header of {length} bytes")
        header = read_json(content[_LENGTH_BYTES : _LENGTH_BYTES + length])
        tensors = load(content)
    except (SafetensorError, KeyError, TypeError) as error:
        raise ValueError(f"not safetensors: {error}") from error
    metadata = header.get("__metadata__", {}) if isinstance(header, dict) else {}
    if not isinstance(metadata, dict) or not all(isinstance(value, str) for value in metadata.values()):
        raise ValueError("its metadata are no texts")
    return metadata, tensors


def read_json(text: bytes | str) -> Any:
    """The value of a JSON text. Raises ValueError, for endless nesting too."""
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("JSON nested without end") from error


def read_ratio(text: object) -> Fraction:
    """A number above 0 written as "30" or "1/30000". Raises ValueError: "1e999999999" would fill the memory."""
    if not isinstance(text, str) or not _RATIO.fullmatch(text):
        raise ValueError(f"{str(text)[:40]!r} is no ratio of two whole numbers")
    numerator, _, denominator = text.partition("/")
    if not int(numerator) or not int(denominator or "1"):
        raise ValueError(f"{text} is not above 0")
    return Fraction(text)
