"""safetensors files taken apart, shaken and put together again, with checksums that fit: the attacker is no fool."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

from .damage import damaged
from .trees import shaken, text_of

_SIZES = {"F64": 8, "I64": 8, "F32": 4, "U32": 4, "I32": 4, "F16": 2, "U16": 2, "I8": 1, "U8": 1, "BOOL": 1}


@dataclass
class TensorFile:
    """A file in pieces."""

    header: dict[str, Any]
    """Tensor -> dtype, shape and data_offsets."""
    metadata: Any
    payload: bytes

    def packed(self) -> bytes:
        """The file; nothing is checked."""
        text = text_of({"__metadata__": self.metadata, **self.header} if isinstance(self.header, dict) else self.header)
        text += b" " * (-len(text) % 8)  # as avatars have it; others may
        return len(text).to_bytes(8, "little") + text + self.payload


def unpacked(content: bytes) -> TensorFile:
    """The pieces of an honest file."""
    end = 8 + int.from_bytes(content[:8], "little")
    header = json.loads(content[8:end])
    return TensorFile(header, header.pop("__metadata__"), content[end:])


def mutated(content: bytes, rng: Random, seal: Callable[[TensorFile, dict[str, Any]], None] | None = None) -> bytes:
    """One mutation of an honest file: of its bytes, its header, its description, its tensors, or their sizes.

    ``seal`` makes checksums in the description fit.
    """
    kind = rng.randrange(6)
    if kind == 0:
        return damaged(content, rng)
    parts = unpacked(content)
    if kind == 1:
        parts.header = shaken(parts.header, rng)
    elif kind == 2:
        parts.payload = damaged(parts.payload, rng)[: len(parts.payload)].ljust(len(parts.payload), b"\0")
    elif kind == 3:
        _resized(parts, rng)
    elif kind == 4:
        parts.metadata = shaken(parts.metadata, rng)
        return parts.packed()
    _describe(parts, rng, kind == 5, seal)
    return parts.packed()


def _describe(
    parts: TensorFile, rng: Random, shake: bool, seal: Callable[[TensorFile, dict[str, Any]], None] | None
) -> None:
    """The JSON texts among the metadata, sealed, and shaken if so asked."""
    for key, text in parts.metadata.items():
        try:
            tree = json.loads(text)
        except ValueError:
            if shake:
                parts.metadata[key] = text_of(shaken(text, rng)).decode("utf-8", "replace")
            continue
        if seal is not None and isinstance(tree, dict) and rng.random() < 0.9:
            seal(parts, tree)
        parts.metadata[key] = text_of(shaken(tree, rng) if shake else tree).decode()


def _resized(parts: TensorFile, rng: Random) -> None:
    """One axis of all tensors gets another length, in the payload too."""
    lengths = [side for entry in parts.header.values() for side in entry["shape"]]
    if not lengths:
        return
    old, new = rng.choice(lengths), rng.choice((0, 1, 2, 3, 17, 1000, 5000))
    payload = bytearray()
    for entry in sorted(parts.header.values(), key=lambda entry: entry["data_offsets"]):
        start, end = entry["data_offsets"]
        if rng.random() < 0.95:
            entry["shape"] = [new if side == old else side for side in entry["shape"]]
        size = _SIZES.get(entry["dtype"], 1)
        for side in entry["shape"]:
            size *= side
        size = min(size, 2**21)
        piece = parts.payload[start:end]
        piece = (piece * (size // max(1, len(piece)) + 1))[:size] if piece else bytes(size)
        entry["data_offsets"] = [len(payload), len(payload) + len(piece)]
        payload += piece
    parts.payload = bytes(payload)


def seal_gem(parts: TensorFile, card: dict[str, Any]) -> None:
    """The checksum of an avatar's description."""
    card["payload_sha256"] = hashlib.sha256(parts.payload).hexdigest()
