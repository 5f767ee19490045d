"""Well-formed files whose tensors or description are not those of an avatar, with checksums that fit."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Refused = Callable[[bytes | Path, str], None]
Pieces = Any
"""conftest.Parts: a file in pieces"""


def sealed(parts: Pieces) -> bytes:
    """The file with checksums that fit: the attacker is no fool."""
    parts.card["payload_sha256"] = hashlib.sha256(parts.payload).hexdigest()
    return parts.pack()


def put(parts: Pieces, name: str, values: Any) -> None:
    """Other numbers into a tensor."""
    place = parts.place(name)
    content = np.asarray(values).tobytes()
    assert len(content) == place.stop - place.start
    parts.payload[place] = content


class TestTensors:
    @pytest.mark.parametrize("name", ["colors", "position.mean", "opacity.kept", "scale.scale", "rotation.components"])
    def test_missing(self, refused: Refused, parts: Pieces, name: str) -> None:
        parts.header["x"] = parts.header.pop(name)
        refused(sealed(parts), f"lacks the tensor '{name}'")

    def test_extra(self, refused: Refused, parts: Pieces) -> None:
        parts.header["pickle.pkl"] = {"dtype": "U8", "shape": [3], "data_offsets": [len(parts.payload)] * 2}
        parts.header["pickle.pkl"]["data_offsets"][1] += 3
        parts.payload += b"abc"
        refused(sealed(parts), "'pickle.pkl', which no avatar has")

    @pytest.mark.parametrize("dtype", ["F64", "BF16", "O", "", None, 4, ["F32"]])
    def test_of_no_known_type(self, refused: Refused, parts: Pieces, dtype: object) -> None:
        parts.header["rest"]["dtype"] = dtype
        refused(sealed(parts), "which no avatar uses")

    @pytest.mark.parametrize(
        ("name", "dtype", "shape"),
        [
            ("rest", "U32", [7]),
            ("rest", "F32", [7, 1]),
            ("position.mean", "F32", [3, 6]),
            ("position.components", "U8", [3, 4, 3]),
            ("position.components", "I8", [4, 3, 3]),
            ("colors", "F16", [18]),
            ("colors", "F16", [3, 6]),
            ("colors", "F16", [9, 2]),
            ("neck_pivot", "U32", [3]),
            ("position.sigma", "F32", [3, 1]),
            ("regressor", "I8", [5]),
            ("regressor", "U8", [5, 1]),
        ],
    )
    def test_of_another_type_or_shape(
        self, refused: Refused, parts: Pieces, name: str, dtype: str, shape: list[int]
    ) -> None:
        parts.header[name] |= {"dtype": dtype, "shape": shape}
        refused(sealed(parts), "instead of|its length must be|its regressor is")

    def test_without_splats(self, refused: Refused, parts: Pieces) -> None:
        lie = {name: entry for name, entry in parts.header.items() if name != "colors"}
        parts.header = {"colors": {"dtype": "F16", "shape": [0, 3], "data_offsets": [0, 0]}, **lie}
        _repacked(parts)
        refused(sealed(parts), "its length must be 1 to 1000000")

    def test_too_many_components(self, refused: Refused, parts: Pieces) -> None:
        count = 513
        for name in ("opacity.sigma", "opacity.scale"):
            parts.header[name]["shape"] = [count]
            parts.header[name]["content"] = b"\0\0\x80\x3f" * count
        _repacked(parts)
        refused(sealed(parts), "its length must be 0 to 512")

    def test_a_small_file_that_would_fill_the_memory(self, refused: Refused, parts: Pieces) -> None:
        """512 empty components over many splats are a few bytes in the file and gigabytes as a basis."""
        splats, count = 110_000, 512
        zeros = {"colors": 6, "neck_weights": 2, "uv_index": 4}
        for name, each in zeros.items():
            parts.header[name] |= {"shape": [splats, *parts.header[name]["shape"][1:]], "content": bytes(each * splats)}
        for name, width in {"position": 3, "rotation": 4, "scale": 3, "opacity": 1}.items():
            ones = b"\0\0\x80\x3f" * count
            parts.header[f"{name}.mean"] |= {"shape": [splats, width], "content": bytes(4 * width * splats)}
            parts.header[f"{name}.components"] |= {"shape": [count, 0, width], "content": b""}
            parts.header[f"{name}.kept"] |= {"shape": [0], "content": b""}
            for part in ("sigma", "scale"):
                parts.header[f"{name}.{part}"] |= {"shape": [count], "content": ones}
        parts.header["arkit_weights"] |= {"shape": [52, 4 * count], "content": bytes(4 * 52 * 4 * count)}
        parts.header["rest"] |= {"shape": [4 * count], "content": bytes(16 * count)}
        _repacked(parts)
        refused(sealed(parts), "GiB of memory")


class TestValues:
    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("name", ["position.mean", "rest", "arkit_weights", "neck_pivot", "scale.sigma"])
    def test_not_finite(self, refused: Refused, parts: Pieces, name: str, bad: float) -> None:
        place = parts.place(name)
        parts.payload[place.start : place.start + 4] = np.float32(bad).tobytes()
        refused(sealed(parts), f"'{name}' has values that are not finite")

    @pytest.mark.parametrize("bad", [0, -1, -1e-30])
    @pytest.mark.parametrize("name", ["position.sigma", "position.scale"])
    def test_no_spread(self, refused: Refused, parts: Pieces, name: str, bad: float) -> None:
        put(parts, name, np.float32([1, 1, bad]))
        refused(sealed(parts), f"'{name}' has values that are not above 0")

    @pytest.mark.parametrize("kept", [[0, 1, 2, 6], [0, 1, 1, 2], [3, 2, 1, 0], [0, 1, 2, 2**32 - 1]])
    def test_splats_that_are_none(self, refused: Refused, parts: Pieces, kept: list[int]) -> None:
        put(parts, "position.kept", np.uint32(kept))
        refused(sealed(parts), "does not rise through the numbers of its 6 splats")

    @pytest.mark.parametrize("bad", [-0.5, 2, 60_000])
    def test_colours_that_are_none(self, refused: Refused, parts: Pieces, bad: float) -> None:
        put(parts, "colors", np.full(18, bad, np.float16))
        refused(sealed(parts), "outside 0 to 1")

    def test_a_place_beyond_the_moon(self, refused: Refused, parts: Pieces) -> None:
        put(parts, "position.mean", np.full(18, 4e8, np.float32))
        refused(sealed(parts), "values beyond 10000")

    def test_a_motion_beyond_all_bounds(self, refused: Refused, parts: Pieces) -> None:
        put(parts, "position.sigma", np.full(3, 3e38, np.float32))
        refused(sealed(parts), "moves splats by more than 10000")

    @pytest.mark.parametrize("name", ["rest", "arkit_weights"])
    def test_a_face_beyond_all_numbers(self, refused: Refused, parts: Pieces, name: str) -> None:
        place = parts.place(name)
        parts.payload[place.start : place.start + 4] = np.float32(3e38).tobytes()
        refused(sealed(parts), f"'{name}' has values beyond 1,000,000")

    def test_texels_outside_the_map(self, refused: Refused, parts: Pieces) -> None:
        parts.card["uv_size"] = 4
        refused(sealed(parts), "outside of a map of 4 texels")


class TestDescription:
    @pytest.mark.parametrize(
        ("key", "value"),
        [
            ("name", 3),
            ("about", {"licence": 3}),
            ("about", []),
            ("basis", "int4"),
            ("basis", []),
            ("uv_size", 0),
            ("uv_size", 2.5),
            ("uv_size", 10**400),
            ("units", {"position": "inch"}),
            ("payload_sha256", "0"),
            ("payload_sha256", "Z" * 64),
            ("regressor", None),
            ("regressor", {"sha256": "0" * 64}),
            ("viewing", None),
            ("viewing", {"target": [0, 0, 0]}),
        ],
    )
    def test_a_field_of_another_kind(self, refused: Refused, parts: Pieces, key: str, value: object) -> None:
        parts.card[key] = value
        refused(parts.pack(), "; ")

    @pytest.mark.parametrize(
        ("key", "value"),
        [
            ("target", [0, 0]),
            ("target", [0, 0, "0"]),
            ("target", [0, 0, 1e9]),
            ("head_height", 0),
            ("head_height", -0.25),
            ("head_height", True),
            ("yaw_limit_deg", 10**400),
            ("pitch_limit_deg", 91),
        ],
    )
    def test_a_view_that_is_none(self, refused: Refused, parts: Pieces, key: str, value: object) -> None:
        parts.card["viewing"][key] = value
        refused(parts.pack(), "viewing|camera limits")

    def test_a_missing_and_an_extra_field(self, refused: Refused, parts: Pieces) -> None:
        parts.card["command"] = parts.card.pop("about")
        refused(parts.pack(), "'about', 'command'")

    def test_more_metadata(self, refused: Refused, parts: Pieces) -> None:
        parts.others["format"] = "pt"
        refused(parts.pack(), "'format'")


class TestRegressor:
    def test_exchanged(self, refused: Refused, parts: Pieces) -> None:
        put(parts, "regressor", np.frombuffer(b"EVIL!", np.uint8))
        refused(sealed(parts), "regressor was exchanged or damaged; train it")

    def test_of_another_avatar(self, refused: Refused, parts: Pieces) -> None:
        """A whole regressor with its seal, copied into the file of somebody else."""
        put(parts, "position.sigma", np.float32([0.5, 0.25, 0.0625]))
        refused(sealed(parts), "trained for another avatar; train it for this avatar")


def _repacked(parts: Pieces) -> None:
    """Lays the tensors out anew, with their "content" where it is given, without gaps."""
    payload = bytearray()
    for entry in parts.header.values():
        content = entry.pop("content", None)
        if content is None:
            itemsize = {"F32": 4, "U32": 4, "F16": 2, "U16": 2}.get(entry["dtype"], 1)
            start, _ = entry["data_offsets"]
            content = bytes(parts.payload[start : start + itemsize * int(np.prod(entry["shape"]))])
        entry["data_offsets"] = [len(payload), len(payload) + len(content)]
        payload += content
    parts.payload = payload
