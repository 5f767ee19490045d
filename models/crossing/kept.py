"""Records of arrays as files, so that a stopped evaluation goes on: whole or not there, taken only for their key."""

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

import numpy as np
from numpy.typing import NDArray

from ..wholefile import write_whole

VERSION = 11
"""Of what is read off pictures and how: another one, and all is done again."""
SUFFIX = ".safetensors"
Record = TypeVar("Record")


class Kept:
    """A folder of records: frozen dataclasses of arrays, texts, numbers and other such dataclasses."""

    def __init__(self, folder: Path) -> None:
        """The folder need not exist."""
        self._folder = folder

    def get(self, what: str, made_of: Sequence[Any], kind: type[Record], make: Callable[[], Record]) -> Record:
        """The record that was made of the same before, else what ``make`` gives, kept. Raises OSError.

        Args:
            what: a word for the file's name.
            made_of: everything that the record depends on, as plain JSON values.
            kind: what it is.
            make: makes it; called only where there is no sound file.
        """
        parts = json.dumps([VERSION, what, *made_of])
        key = hashlib.sha256(parts.encode()).hexdigest()
        path = self._folder / f"{what}-{key[:16]}{SUFFIX}"
        record = _load(path, key, kind)
        if record is None:
            record = make()
            _save(path, key, record)
        return record


def _save(path: Path, key: str, record: object) -> None:
    from safetensors.numpy import save

    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, [save(dict(_flattened(record)), {"key": key})])


def _load(path: Path, key: str, kind: type[Record]) -> Record | None:
    """None where there is nothing, or nothing to be trusted: all can be made again."""
    from safetensors import SafetensorError, safe_open

    if not path.is_file():
        return None
    try:
        with safe_open(path, "numpy") as file:
            if (file.metadata() or {}).get("key") != key:
                return None
            return _rebuilt(kind, {name: file.get_tensor(name) for name in file.keys()})  # noqa: SIM118
    except (OSError, ValueError, KeyError, TypeError, SafetensorError):
        return None


def _flattened(record: Any, prefix: str = "") -> list[tuple[str, NDArray[Any]]]:
    """Field names, those of inner records behind a dot, and their values as arrays."""
    tensors: list[tuple[str, NDArray[Any]]] = []
    for field in fields(record):
        value = getattr(record, field.name)
        if is_dataclass(value):
            tensors += _flattened(value, f"{prefix}{field.name}.")
        elif isinstance(value, str):
            tensors.append((prefix + field.name, np.frombuffer(value.encode(), np.uint8)))
        else:
            tensors.append((prefix + field.name, np.ascontiguousarray(value)))
    return tensors


def _rebuilt(kind: type[Record], tensors: dict[str, NDArray[Any]], prefix: str = "") -> Record:
    values: dict[str, Any] = {}
    for name, hint in get_type_hints(kind).items():
        if is_dataclass(hint) and isinstance(hint, type):
            values[name] = _rebuilt(hint, tensors, f"{prefix}{name}.")
        elif hint is str:
            values[name] = tensors[prefix + name].tobytes().decode()
        elif hint in (int, float):
            values[name] = hint(tensors[prefix + name].item())
        else:
            values[name] = tensors[prefix + name]
    return kind(**values)
