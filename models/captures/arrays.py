"""Arrays of an .npz, each checked before it is let in. Nothing is unpickled."""

import math
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.lib.format as npy
from numpy.typing import NDArray

from ..wholefile import open_ordinary
from .layout import CaptureError

MAX_BYTES = 64 * 2**20
"""Of all arrays of a mesh, unpacked: far above any head's, far below what exhausts memory."""
_MAX_DIRECTORY = 2**16
"""Bytes of an archive's list of what is in it; zipfile makes a hundred times as many of them."""
_DIRECTORY_END, _LARGE_END, _END_BYTES, _LARGE_END_BYTES = b"PK\5\6", b"PK\6\7", 22, 20
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
_BROKEN = (
    *(OSError, ValueError, EOFError, KeyError, TypeError, SyntaxError, OverflowError, RuntimeError),
    *(zipfile.BadZipFile, zlib.error, NotImplementedError, tokenize.TokenError),
)
"""What the readers of archives and of array headers raise where there is none."""
_AGAIN = "write it anew with numpy.savez (docs/captures.md lists its arrays)"


def load_arrays(path: Path, names: tuple[str, ...], at_most: int = MAX_BYTES) -> Mapping[str, NDArray[Any]]:
    """Those of ``names`` that the file has.

    Raises CaptureError where the file is missing, is no .npz, holds objects, or where those arrays together unpack to
    more than ``at_most`` bytes.
    """
    if not path.is_file():
        raise CaptureError(path, "is missing", "every timestep needs its mesh, and the capture its template.npz")
    try:
        with open_ordinary(path) as (file, _):
            _check_directory(file)
            with zipfile.ZipFile(file) as packed:
                entries = {entry.filename.removesuffix(".npy"): entry for entry in packed.infolist()}
                wanted = {name: entries[name] for name in names if name in entries}
                if (size := sum(entry.file_size for entry in wanted.values())) > at_most:
                    raise ValueError(f"it unpacks to {size / 2**20:.0f} MiB, at most {at_most / 2**20:.0f} are read")
                return {name: _array(packed, entry) for name, entry in wanted.items()}
    except _BROKEN as error:
        raise CaptureError(path, f"cannot be read as an .npz of plain arrays ({error})", _AGAIN) from error


def _check_directory(file: BinaryIO) -> None:
    """Makes sure that the archive ends as numpy writes it, with a short list of what is in it. Raises ValueError."""
    size = file.seek(0, 2)
    file.seek(max(0, size - _END_BYTES - _LARGE_END_BYTES))
    before, end = (tail := file.read())[:-_END_BYTES], tail[-_END_BYTES:]
    if not end.startswith(_DIRECTORY_END):
        raise ValueError("it does not end as an archive does")
    if before.startswith(_LARGE_END) or int.from_bytes(end[12:16], "little") > _MAX_DIRECTORY:
        raise ValueError("it is an archive of more than arrays")


def _array(packed: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any]:
    """One array, whose header is held against the bytes that are there before memory is taken. Raises ValueError."""
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):  # others ask for memory by themselves
        raise ValueError(f"{entry.filename[:40]} is packed otherwise than by numpy")
    with packed.open(entry) as file:
        read_header = _HEADERS.get(npy.read_magic(file))
        if read_header is None:
            raise ValueError(f"{entry.filename[:40]} is of no known version")
        shape, by_columns, dtype = read_header(file)
        size = math.prod(shape) * dtype.itemsize
        if dtype.hasobject or min(shape, default=0) < 0 or size != entry.file_size - file.tell():
            raise ValueError(f"{entry.filename[:40]} does not hold the numbers that it tells of")
        values = np.frombuffer(file.read(size), dtype)
    return values.reshape(shape, order="F" if by_columns else "C")


def floats(path: Path, name: str, values: NDArray[Any], shape: tuple[int | None, ...]) -> NDArray[np.float32]:
    """``values`` as float32, of ``shape`` (None: any length) and finite. Raises CaptureError."""
    _check_shape(path, name, values, shape)
    if values.dtype.kind not in "fiu":
        raise CaptureError(path, f"{name} holds {values.dtype}, not numbers", _AGAIN)
    answer = np.ascontiguousarray(values, np.float32)
    if not np.isfinite(answer).all():
        bad = int(np.flatnonzero(~np.isfinite(answer).reshape(len(answer), -1).all(1))[0])
        raise CaptureError(path, f"{name}[{bad}] is not finite", "track that moment again, or leave it out")
    return answer


def indices(path: Path, name: str, values: NDArray[Any], columns: int | None, below: int) -> NDArray[np.int32]:
    """``values`` [T] or [T, columns] as int32 in 0..below - 1. Raises CaptureError."""
    _check_shape(path, name, values, (None,) if columns is None else (None, columns))
    if values.dtype.kind not in "iu":
        raise CaptureError(path, f"{name} holds {values.dtype}, not integers", _AGAIN)
    if values.size and not (values.min() >= 0 and values.max() < below):
        raise CaptureError(path, f"{name} reaches {values.min()}..{values.max()}, but there are {below}", _AGAIN)
    return np.ascontiguousarray(values, np.int32)


def _check_shape(path: Path, name: str, values: NDArray[Any], shape: tuple[int | None, ...]) -> None:
    fits = values.ndim == len(shape) and all(
        want in (None, have) for want, have in zip(shape, values.shape, strict=True)
    )
    if not fits:
        wanted = " x ".join("any" if want is None else str(want) for want in shape)
        raise CaptureError(path, f"{name} is {' x '.join(map(str, values.shape))}, not {wanted}", _AGAIN)
