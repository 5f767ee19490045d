"""Files that want to be avatars and are not: each has a story, and each gives one error that says what, where, cure."""

import json
import pickle
import resource
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from gemheads.models.gemfile import GemFormatError, load_gem, read_info
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

Refused = Callable[[bytes | Path, str], None]
Raw = Callable[..., bytes]
Pieces = Any
"""conftest.Parts: a file in pieces"""


class TestNoFile:
    def test_missing(self, refused: Refused, tmp_path: Path) -> None:
        refused(tmp_path / "nobody.gem", "No such file.*check the path")

    def test_a_folder(self, refused: Refused, tmp_path: Path) -> None:
        refused(tmp_path, "no ordinary file")

    def test_an_endless_device(self, refused: Refused) -> None:
        refused(Path("/dev/zero"), "no ordinary file")

    def test_a_name_with_a_null_byte(self) -> None:
        with pytest.raises(GemFormatError, match="cannot be read"):
            load_gem("a\0b.gem")


class TestAnotherKindOfFile:
    @pytest.mark.parametrize("content", [b"", b"\0", b"\0" * 8, b"\xff" * 8, b"\xff" * 4000, b"#!/bin/sh\necho\n"])
    def test_bytes(self, refused: Refused, content: bytes) -> None:
        refused(content, "empty|does not start with a safetensors header")

    def test_a_pickle_is_not_unpickled(self, refused: Refused, raw: Raw, tmp_path: Path) -> None:
        class Bomb:
            def __reduce__(self) -> tuple[Any, ...]:
                return Path.touch, (tmp_path / "exploded",)

        for content in (pickle.dumps(Bomb()), raw(pickle.dumps(Bomb()))):
            refused(content, "no avatar|not the JSON")
        assert not (tmp_path / "exploded").exists()

    def test_plain_safetensors(self, refused: Refused, raw: Raw) -> None:
        refused(raw(b"{}"), "no avatar; give a .gem file")
        refused(raw(b'{"__metadata__":{"format":"pt"}}'), "no avatar; give a .gem file")

    def test_huge(self, refused: Refused, tmp_path: Path) -> None:
        path = tmp_path / "huge.gem"
        with path.open("wb") as file:
            file.truncate(2**40)  # sparse
        refused(path, "an avatar has at most")


class TestDamaged:
    def test_cut_off_anywhere(self, refused: Refused, sound: bytes) -> None:
        for length in [*range(0, 64, 5), *range(64, len(sound), 301), len(sound) - 1]:
            refused(sound[:length], "empty|safetensors header|cut off|not the JSON")

    def test_something_behind(self, refused: Refused, sound: bytes) -> None:
        refused(sound + b"\0", "cut off or has grown")

    def test_one_bit_of_the_payload(self, refused: Refused, parts: Pieces) -> None:
        parts.payload[parts.place("position.components")][0] ^= 1
        parts.payload[parts.place("position.components").start] ^= 1
        refused(parts.pack(), "checksum does not fit")

    @pytest.mark.parametrize("version", [0, 2, 999, "1", None, True, [1]])
    def test_another_version(self, refused: Refused, parts: Pieces, version: object) -> None:
        parts.card["version"] = version
        refused(parts.pack(), "this program reads 1; update gemheads")


class TestHeader:
    def test_longer_than_the_file(self, refused: Refused) -> None:
        refused((2**16).to_bytes(8, "little") + b"{}", "cut off")

    @pytest.mark.parametrize("more", [1, 3, 4])
    def test_of_a_length_that_is_no_multiple_of_eight(self, refused: Refused, sound: bytes, more: int) -> None:
        length = int.from_bytes(sound[:8], "little")
        header = sound[8 : 8 + length] + b" " * more
        refused(len(header).to_bytes(8, "little") + header + sound[8 + length :], "is no multiple of 8")

    def test_longer_than_any_memory(self, refused: Refused) -> None:
        refused((2**63).to_bytes(8, "little") + b"{}", "does not start with a safetensors header")

    def test_of_a_million_tensors(self, refused: Refused, raw: Raw) -> None:
        entry = {"dtype": "U8", "shape": [0], "data_offsets": [0, 0]}
        text = json.dumps({str(i): entry for i in range(1_000_000 // 20)}).encode()
        refused(raw(text), "does not start with a safetensors header")

    def test_of_many_empty_tensors(self, refused: Refused, raw: Raw) -> None:
        entry = {"dtype": "U8", "shape": [0], "data_offsets": [0, 0]}
        refused(raw(json.dumps(dict.fromkeys(map(str, range(900)), entry)).encode()), "no avatar")

    @pytest.mark.parametrize("opening", [b"[", b'{"a":'])
    def test_nested_without_end(self, refused: Refused, raw: Raw, opening: bytes) -> None:
        refused(raw(opening * (60_000 // len(opening))), "not the JSON")

    @pytest.mark.parametrize(
        "text", [b"[]", b"12", b"{ ", b"\xff\xfe", b'{"a":NaN}', b'{"a":1,"a":2}', b'{"a":' + b"9" * 60_000 + b"}"]
    )
    def test_of_strange_json(self, refused: Refused, raw: Raw, text: bytes) -> None:
        refused(raw(text), "not the JSON|not a JSON object")

    @pytest.mark.parametrize("metadata", [3, [], "x", {"gemheads": 3}, {"gemheads": None}])
    def test_metadata_of_another_kind(self, refused: Refused, raw: Raw, metadata: object) -> None:
        refused(raw(json.dumps({"__metadata__": metadata}).encode()), "no table of texts")

    def test_the_same_tensor_twice(self, refused: Refused, raw: Raw, parts: Pieces) -> None:
        entry = json.dumps({"rest": parts.header["rest"]})[1:-1].encode()
        text = parts.pack()
        end = 8 + int.from_bytes(text[:8], "little")
        refused(raw(b"{" + entry + b"," + text[9:end], text[end:]), "a key stands twice")


class TestPlaces:
    @pytest.mark.parametrize(
        ("shape", "offsets"),
        [
            ([2**60], [0, 8]),
            ([2**40, 2**40, 0], [0, 0]),
            ([-1], [0, 4]),
            ([1.0], [0, 4]),
            ([True], [0, 4]),
            ("7", [0, 28]),
            ([1] * 9, [0, 4]),
            ([7], [0]),
            ([7], [28, 0]),
            ([7], [-28, 0]),
            ([7], [0, 2**62]),
            ([7], None),
            ([8], [0, 28]),
        ],
    )
    def test_impossible(self, refused: Refused, parts: Pieces, shape: object, offsets: object) -> None:
        parts.header["rest"] = {"dtype": "F32", "shape": shape, "data_offsets": offsets}
        refused(parts.pack(), "impossible|does not fit its|instead of")

    def test_overlapping(self, refused: Refused, parts: Pieces) -> None:
        parts.header["position.scale"]["data_offsets"] = parts.header["position.sigma"]["data_offsets"]
        refused(parts.pack(), "of the payload instead of")

    def test_narrow_types_before_wide_ones(self, refused: Refused, parts: Pieces) -> None:
        turned, payload = {}, bytearray()
        for name, entry in reversed(parts.header.items()):
            piece = parts.payload[parts.place(name)]
            turned[name] = {**entry, "data_offsets": [len(payload), len(payload) + len(piece)]}
            payload += piece
        parts.header, parts.payload = turned, payload
        refused(parts.pack(), "lies behind one of a narrower type")

    def test_a_hidden_gap(self, refused: Refused, parts: Pieces) -> None:
        for entry in parts.header.values():
            entry["data_offsets"] = [offset + 8 for offset in entry["data_offsets"]]
        parts.payload[:0] = b"smuggled"
        refused(parts.pack(), "of the payload instead of 0")

    @pytest.mark.parametrize("entry", [None, [], {"dtype": "F32"}, {"dtype": "F32", "shape": [1], "extra": 1}])
    def test_not_described(self, refused: Refused, parts: Pieces, entry: object) -> None:
        parts.header["rest"] = entry
        refused(parts.pack(), "not described by")


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    edits=st.lists(st.tuples(st.integers(0, 2**13), st.binary(min_size=1, max_size=9)), min_size=1, max_size=4),
    cut=st.integers(0, 2**13),
)
def test_any_bytes_open_or_are_refused(sound: bytes, edits: list[tuple[int, bytes]], cut: int) -> None:
    content = bytearray(sound)
    for place, piece in edits:
        start = place % len(content)
        content[start : start + len(piece)] = piece
    content = content[: max(cut, len(content) // 2)]
    messages: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fuzzed.gem"
        path.write_bytes(content)
        for opening in (load_gem, read_info):
            try:
                opening(path)
            except GemFormatError as error:
                messages.append(str(error))
    assert all(message.startswith(str(path)) for message in messages)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 8e6
