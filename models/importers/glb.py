"""Binary glTF 2.0, as far as a mesh with morph targets needs it, from files that nobody vouches for.

Only what lies within the file is read: no external URIs, no compression, no extensions. Every count is held against
the bytes that are there, or against a count that was, before memory is taken.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from .foreign import ForeignFormatError, opened

CURE = "export it again as plain, self-contained binary glTF 2.0"
MAX_JSON_BYTES = 8 * 2**20
"""Of a head with a skeleton: 80 kB."""
FLOAT = {5126: np.dtype("<f4")}
"""glTF's number of a component type -> what it is, for lengths."""
INDEX = {5121: np.dtype("u1"), 5123: np.dtype("<u2"), 5125: np.dtype("<u4")}
"""The same, for indices."""
_WIDTH = {"SCALAR": 1, "VEC3": 3}
_MAGIC, _JSON, _BIN = b"glTF", b"JSON", b"BIN\0"


@dataclass(frozen=True)
class Glb:
    """An opened file: its JSON tree, and its one buffer."""

    path: Path
    tree: Mapping[str, Any]
    buffer: bytes

    def wrong(self, what: str) -> ForeignFormatError:
        """The error that says so, to be raised."""
        return ForeignFormatError(self.path, what, CURE)

    def item(self, kind: str, index: object) -> Mapping[str, Any]:
        """Entry ``index`` of one of the top-level lists, such as "accessors". Raises ForeignFormatError."""
        entries = self.tree.get(kind)
        if not isinstance(entries, list) or not _whole(index, len(entries) - 1):
            raise self.wrong(f"it has no entry {_short(index)} among its {kind}")
        entry = entries[index]
        if not isinstance(entry, dict):
            raise self.wrong(f"entry {index} of its {kind} is not an object")
        return entry

    def array(
        self,
        index: object,
        what: str,
        kind: str,
        types: Mapping[int, np.dtype[Any]],
        count: int | None = None,
        most: int | None = None,
    ) -> NDArray[Any]:
        """The numbers of an accessor, [count] or [count, 3].

        Args:
            index: which accessor.
            what: its name in messages.
            kind: the glTF type it must have, "SCALAR" or "VEC3".
            types: the component types it may have.
            count: how many elements it must have; None takes any number that lies in the buffer whole ...
            most: ... up to so many.

        Raises:
            ForeignFormatError: for anything else, and where a number is not finite.
        """
        accessor = self.item("accessors", index)
        if accessor.get("type") != kind:
            raise self.wrong(f"its {what} are {_short(accessor.get('type'))} instead of {kind}")
        dtype = self._dtype(accessor, what, types)
        claimed = accessor.get("count")
        if not _whole(claimed, len(self.buffer) if count is None else count) or claimed != (count or claimed):
            raise self.wrong(f"its {what} count {_short(claimed)} instead of {count or 'what the file holds'}")
        if most is not None and claimed > most:
            raise self.wrong(f"it has {claimed} {what}, {most} are read")
        if "bufferView" in accessor:
            values = self._view(accessor, what, dtype, claimed, _WIDTH[kind])
        elif count is None:
            raise self.wrong(f"its {what} lie nowhere: the accessor has no bufferView")
        else:
            values = np.zeros((count, _WIDTH[kind]), dtype)
        if "sparse" in accessor:
            values = self._sparse(accessor["sparse"], what, values)
        if dtype.kind == "f" and not np.isfinite(values).all():
            raise self.wrong(f"its {what} are not all finite")
        return values[:, 0] if kind == "SCALAR" else values

    def _dtype(self, holder: Mapping[str, Any], what: str, types: Mapping[int, np.dtype[Any]]) -> np.dtype[Any]:
        number = holder.get("componentType")
        if not isinstance(number, int) or number not in types or holder.get("normalized", False) is not False:
            raise self.wrong(f"its {what} have the component type {_short(number)}, not one of {list(types)}")
        return types[number]

    def _view(self, place: Mapping[str, Any], what: str, dtype: np.dtype[Any], count: int, width: int) -> NDArray[Any]:
        """[count, width] numbers of a buffer view, in memory of their own."""
        view = self.item("bufferViews", place.get("bufferView"))
        if view.get("buffer") != 0:
            raise self.wrong(f"its {what} lie in another buffer than the file's own")
        start, length, inside = view.get("byteOffset", 0), view.get("byteLength"), place.get("byteOffset", 0)
        element = width * dtype.itemsize
        stride = view.get("byteStride", element)
        size = len(self.buffer)
        if not (_whole(start, size) and _whole(length, size - start) and _whole(inside, length)):
            raise self.wrong(f"its {what} lie outside of the buffer of {size} bytes")
        if not _whole(stride, 252) or stride < element or stride % dtype.itemsize:
            raise self.wrong(f"its {what} have an impossible stride of {_short(stride)} bytes")
        if count and inside + stride * (count - 1) + element > length:
            raise self.wrong(f"{count} of its {what} do not fit their {length} bytes")
        cells = np.ndarray((count, width), dtype, self.buffer, start + inside, (stride, dtype.itemsize))
        return np.array(cells)

    def _sparse(self, sparse: object, what: str, values: NDArray[Any]) -> NDArray[Any]:
        """The values with some exchanged for others."""
        table: Mapping[str, Any] = sparse if isinstance(sparse, dict) else {}
        indices, changes, count = table.get("indices"), table.get("values"), table.get("count")
        if not isinstance(indices, dict) or not isinstance(changes, dict) or not _whole(count, len(values)):
            raise self.wrong(f"the sparse part of its {what} lacks indices, values or a possible count")
        name = f"sparse {what}"
        rows = self._view(indices, name, self._dtype(indices, name, INDEX), count, 1)[:, 0].astype(np.int64)
        if (rows >= len(values)).any():
            raise self.wrong(f"the sparse part of its {what} points beyond its {len(values)} elements")
        values[rows] = self._view(changes, name, values.dtype, count, values.shape[1])
        return values


def read_glb(path: Path) -> Glb:
    """Opens a binary glTF file. Raises ForeignFormatError for all that is none, and for what would need more files."""
    with opened(path, CURE) as (file, size):
        head = file.read(20)
        if len(head) < 20 or head[:4] != _MAGIC or head[16:20] != _JSON:
            raise ForeignFormatError(path, "this is no binary glTF", "give the avatar's .glb")
        version, told, length = (int.from_bytes(head[i : i + 4], "little") for i in (4, 8, 12))
        if version != 2 or told != size:
            raise ForeignFormatError(path, f"version {version}, {told} bytes told and {size} there", CURE)
        if length > min(MAX_JSON_BYTES, size - 20):
            raise ForeignFormatError(path, f"its description claims {length} bytes", CURE)
        text = file.read(length)
        chunk = file.read(8)
        extent = int.from_bytes(chunk[:4], "little")
        if len(chunk) < 8 or chunk[4:] != _BIN or extent > size - 28 - length:
            raise ForeignFormatError(path, "its buffer is missing or cut off", CURE)
        buffer = file.read(extent)
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ForeignFormatError(path, f"its description is no JSON ({type(error).__name__})", CURE) from error
    if not isinstance(tree, dict):
        raise ForeignFormatError(path, "its description is not a JSON object", CURE)
    glb = Glb(path, tree, buffer)
    if tree.get("extensionsRequired"):
        raise glb.wrong(f"it needs the extensions {_short(tree['extensionsRequired'])}, which are not read")
    buffers = tree.get("buffers")
    if not isinstance(buffers, list) or len(buffers) != 1 or "uri" in glb.item("buffers", 0):
        raise glb.wrong("its numbers lie in other files or in several buffers")
    return glb


def _whole(value: object, high: int) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= high


def _short(value: object) -> str:
    return repr(value)[:60]
