"""Pictures as files."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ...models.wholefile import open_ordinary, write_whole
from ..errors import cannot_write

_HEAD = 33
"""Bytes of a PNG's signature and first chunk, which says the size; others may follow in any order."""


def write_png(image: NDArray[np.uint8], out: Path) -> None:
    """Write sRGB [H, W, 3] as a PNG that ``drawn_here`` knows again, making the folder where it is missing. Raises
    OutputError."""
    png = cv2.imencode(".png", np.ascontiguousarray(image[..., ::-1]))[1].tobytes()
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        write_whole(out, [png[:_HEAD], _MARK, png[_HEAD:]])
    except OSError as error:
        raise cannot_write(out, error) from error


def drawn_here(path: Path) -> bool:
    """Whether ``write_png`` wrote this file, as far as the file says. Raises OSError where it cannot be read."""
    with open_ordinary(path) as (file, _):
        return file.read(_HEAD + len(_MARK))[_HEAD:] == _MARK


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


_MARK = _chunk(b"tEXt", b"Software\0gemheads")
