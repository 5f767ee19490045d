"""Files taken apart and put together again, well or badly."""

import json
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest
from gemheads.models.gem import Gem
from gemheads.models.gemfile import GemFormatError, load_gem, save_gem


@dataclass
class Parts:
    """A .gem file in pieces; ``pack`` seals nothing and checks nothing."""

    header: dict[str, Any]
    card: dict[str, Any]
    payload: bytearray
    others: dict[str, str] = field(default_factory=dict)
    """More metadata beside the card."""

    def pack(self) -> bytes:
        metadata = {"gemheads": json.dumps(self.card), **self.others}
        return framed(json.dumps({"__metadata__": metadata, **self.header}).encode(), bytes(self.payload))

    def place(self, name: str) -> slice:
        """Where a tensor lies in the payload."""
        return slice(*self.header[name]["data_offsets"])


def framed(header: bytes, payload: bytes = b"") -> bytes:
    """Any bytes behind an honest length, which is a multiple of 8."""
    header += b" " * (-len(header) % 8)
    return len(header).to_bytes(8, "little") + header + payload


@pytest.fixture
def raw() -> Callable[..., bytes]:
    """``framed``, for tests."""
    return framed


@pytest.fixture
def sound(tiny_gem: Gem, tmp_path: Path) -> bytes:
    """A file that opens."""
    save_gem(replace(tiny_gem, regressor=b"graph"), tmp_path / "sound.gem")
    return (tmp_path / "sound.gem").read_bytes()


@pytest.fixture
def parts(sound: bytes) -> Parts:
    """The same file in pieces."""
    end = 8 + int.from_bytes(sound[:8], "little")
    header = json.loads(sound[8:end])
    card = json.loads(header.pop("__metadata__")["gemheads"])
    return Parts(header, card, bytearray(sound[end:]))


@pytest.fixture
def refused(tmp_path: Path) -> Callable[[bytes | Path, str], None]:
    """Opening these bytes, or this path, gives one GemFormatError: path, reason, cure; soon and with little memory."""

    def check(content: bytes | Path, said: str) -> None:
        path = content if isinstance(content, Path) else tmp_path / "hostile.gem"
        if isinstance(content, bytes):
            path.write_bytes(content)
        tracemalloc.start()
        start = time.perf_counter()
        with pytest.raises(GemFormatError, match=said) as caught:
            load_gem(path)
        seconds, (_, peak) = time.perf_counter() - start, tracemalloc.get_traced_memory()
        tracemalloc.stop()
        message = str(caught.value)
        assert message.startswith(f"{path}: ")
        assert "; " in message
        assert "\n" not in message
        assert len(message) < len(str(path)) + 500
        assert seconds < 2
        assert peak < 8e6

    return check
