"""Arrays of an .npz, each checked before it is let in. Nothing is unpickled."""

import math
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.lib.format as npy
from numpy.typing import NDArray

from .layout import CaptureError

MAX_BYTES = 256 * 2**20
"""Of one unpacked array: far above any head mesh, far below what exhausts memory."""
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
_BROKEN = (
    *(OSError, ValueError, EOFError, KeyError, TypeError, SyntaxError, OverflowError, RuntimeError),
    *(zipfile.BadZipFile, zlib.error, NotImplementedError, tokenize.TokenError),
)
"""What the readers of archives and of array headers raise where there is none."""
_AGAIN = "write it anew with numpy.savez (docs/captures.md lists its arrays)"


def load_arrays(path: Path, names: tuple[str, ...]) -> Mapping[str, NDArray[Any]]:
    """Those of ``names`` that the file has.

    Raises CaptureError where the file is missing, is no .npz, or holds objects or arrays larger than MAX_BYTES.
    """
    if not path.is_file():
        raise CaptureError(path, "is missing", "every timestep needs its mesh, and the capture its template.npz")
    try:
        with zipfile.ZipFile(path) as packed:
            entries = {entry.filename.removesuffix(".npy"): entry for entry in packed.infolist()}
            return {name: _array(packed, entries[name]) for name in names if name in entries}
    except _BROKEN as error:
        raise CaptureError(path, f"cannot be read as an .npz of plain arrays ({error})", _AGAIN) from error


def _array(packed: zipfile.ZipFile, entry: zipfile.ZipInfo) -> NDArray[Any]:
    """One array, whose header is held against the bytes that are there before memory is taken. Raises ValueError."""
    if entry.file_size > MAX_BYTES:
        raise ValueError(f"{entry.filename[:40]} unpacks to {entry.file_size / 2**20:.0f} MiB")
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
