"""An avatar as one file, ``.gem``: safetensors with one JSON text. docs/gem-format.md is the contract.

Nothing in a file is run or unpickled, and nothing is allocated before the header has been checked.
"""

import hashlib
import io
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .compaction import Compact, compact, expand
from .gem import CHANNELS, CLAMP_SIGMAS, MODALITIES, Basis, Gem
from .gemcard import BASIS_TYPES, KEY, Card, Seal, card_text, read_card
from .gemheader import GemFormatError, Header, header_bytes, read_header
from .gemlayout import BASIS_PARTS, Layout, check_layout, check_motion, check_values
from .wholefile import open_ordinary, write_whole

Tensors = dict[str, NDArray[Any]]
_ANOTHERS = "train it for this avatar (gemheads train-regressor)"


@dataclass(frozen=True)
class GemInfo:
    """What a file's header says; of the tensors nothing has been read."""

    card: Card
    layout: Layout
    bytes: int
    """Size of the file."""


def save_gem(gem: Gem, path: str | Path, basis: str = "int8") -> None:
    """Writes an avatar; the file appears whole or not at all.

    Components are stored as ``basis`` "int8" (a scale per component) or "fp16", without the splats that hardly move.
    An avatar that was loaded from such a file is stored again without any further loss.

    Raises:
        ValueError: for another ``basis``, and for an avatar that ``load_gem`` would refuse.
        OSError: where the file cannot be written; what was there before stays.
    """
    if basis not in BASIS_TYPES:
        raise ValueError(f"a basis is stored as one of {list(BASIS_TYPES)}, not {basis!r}")
    tensors = _tensors(gem, basis)
    for name, values in tensors.items():
        check_values(name, values, len(gem))
    reach = _reach(tensors)
    for name in MODALITIES:
        check_motion(name, tensors[f"{name}.components"], tensors[f"{name}.scale"], reach[name])
    _check_texels(gem.uv_index, gem.uv_size)
    payload = [np.ascontiguousarray(tensor).data for tensor in tensors.values()]
    seal = None
    if gem.regressor is not None:
        seal = Seal(hashlib.sha256(gem.regressor).hexdigest(), _bases_sha256(tensors))
    digest = hashlib.sha256()
    for part in payload:
        digest.update(part)
    card = Card(gem.name, gem.about, gem.viewing, gem.uv_size, basis, digest.hexdigest(), seal)
    head = header_bytes({KEY: card_text(card)}, tensors)
    header = read_header(io.BytesIO(head), len(head) + sum(part.nbytes for part in payload))
    check_layout(header, read_card(header.metadata))  # what is written can be opened
    write_whole(Path(path), [head, *payload])


def load_gem(path: str | Path) -> Gem:
    """Reads an avatar, as ``save_gem`` wrote it.

    Raises GemFormatError for everything that is no sound avatar, within bounded memory and time.
    """
    with _opened(Path(path)) as (file, size):
        header = read_header(file, size)
        card = read_card(header.metadata)
        layout = check_layout(header, card)
        return _gem(_read(file, header, layout, card), layout, card)


def read_info(path: str | Path) -> GemInfo:
    """What a file's header says, without reading its tensors. Raises GemFormatError."""
    with _opened(Path(path)) as (file, size):
        header = read_header(file, size)
        card = read_card(header.metadata)
        return GemInfo(card, check_layout(header, card), size)


def _tensors(gem: Gem, basis: str) -> Tensors:
    tensors: Tensors = {}
    for name in MODALITIES:
        stored = compact(name, gem.bases[name], basis)
        tensors[f"{name}.mean"] = gem.bases[name].mean.reshape(-1, CHANNELS[name])
        tensors[f"{name}.components"] = stored.values
        tensors[f"{name}.scale"] = stored.scale
        tensors[f"{name}.sigma"] = gem.bases[name].sigma
        tensors[f"{name}.kept"] = stored.kept
    tensors["colors"] = gem.colors.astype(np.float16)
    tensors["neck_weights"] = gem.neck_weights.astype(np.float16)
    tensors["neck_pivot"] = np.asarray(gem.neck_pivot, np.float32)
    tensors["uv_index"] = gem.uv_index.astype(np.uint16)
    if gem.arkit_weights is not None:
        tensors["arkit_weights"] = gem.arkit_weights.astype(np.float32)
    if gem.rest is not None:
        tensors["rest"] = gem.rest.astype(np.float32)
    if gem.regressor is not None:
        tensors["regressor"] = np.frombuffer(gem.regressor, np.uint8)
    # wide numbers first: every tensor is then aligned
    return dict(sorted(tensors.items(), key=lambda item: -item[1].dtype.itemsize))


def _bases_sha256(tensors: Mapping[str, NDArray[Any]]) -> str:
    """Of all that gives coefficients their meaning."""
    digest = hashlib.sha256()
    for name in (f"{modality}.{part}" for modality in MODALITIES for part in BASIS_PARTS):
        digest.update(f"{name} {tensors[name].dtype.str} {tensors[name].shape}\n".encode())
        digest.update(np.ascontiguousarray(tensors[name]).data)
    return digest.hexdigest()


def _read(file: BufferedReader, header: Header, layout: Layout, card: Card) -> Tensors:
    tensors: Tensors = {}
    digest = hashlib.sha256()
    for name, entry in header.entries.items():
        values = np.empty(entry.shape, entry.dtype)
        file.seek(header.payload + entry.start)
        view = values.reshape(-1).view(np.uint8).data
        if file.readinto(view) != view.nbytes:
            raise GemFormatError(f"the file ends within the tensor {name!r}")
        digest.update(view)
        check_values(name, values, layout.splats)
        tensors[name] = values
    if digest.hexdigest() != card.payload_sha256:
        raise GemFormatError("its contents were changed or damaged: the checksum does not fit")
    return tensors


def _gem(tensors: Tensors, layout: Layout, card: Card) -> Gem:
    reach = _reach(tensors)
    bases = {name: _basis(name, tensors, layout, reach[name]) for name in MODALITIES}
    _check_texels(tensors["uv_index"], card.uv_size)
    graph = None
    if card.regressor is not None:
        graph = tensors["regressor"].tobytes()
        if hashlib.sha256(graph).hexdigest() != card.regressor.sha256:
            raise GemFormatError("its regressor was exchanged or damaged", _ANOTHERS)
        if _bases_sha256(tensors) != card.regressor.bases_sha256:
            raise GemFormatError("its regressor was trained for another avatar", _ANOTHERS)
    return Gem(
        name=card.name,
        bases=bases,
        colors=tensors["colors"].astype(np.float32),
        neck_weights=tensors["neck_weights"].astype(np.float32),
        neck_pivot=tensors["neck_pivot"],
        uv_index=tensors["uv_index"],
        uv_size=card.uv_size,
        viewing=card.viewing,
        arkit_weights=tensors.get("arkit_weights"),
        rest=tensors.get("rest"),
        regressor=graph,
        about=card.about,
    )


def _reach(tensors: Tensors) -> dict[str, NDArray[np.float32]]:
    """[K] of each modality: how far its coefficients go, driven or at rest, in CLAMP_SIGMAS."""
    reach, start = {}, 0
    for name in MODALITIES:
        sigma = tensors[f"{name}.sigma"]
        rest = tensors["rest"][start : start + len(sigma)] if "rest" in tensors else np.zeros_like(sigma)
        reach[name], start = np.maximum(sigma, np.abs(rest) / CLAMP_SIGMAS), start + len(sigma)
    return reach


def _basis(name: str, tensors: Tensors, layout: Layout, reach: NDArray[np.float32]) -> Basis:
    values, scale, sigma = (tensors[f"{name}.{part}"] for part in ("components", "scale", "sigma"))
    check_motion(name, values, scale, reach)
    rows = np.zeros((len(sigma) + 1, layout.splats * CHANNELS[name]), np.float32)
    rows[0] = tensors[f"{name}.mean"].reshape(-1)
    expand(Compact(tensors[f"{name}.kept"], values, scale), rows[1:])
    return Basis(rows, sigma)


def _check_texels(uv_index: NDArray[np.uint16], uv_size: int) -> None:
    if (uv_index >= uv_size).any():
        raise GemFormatError(f"its UV index points outside of a map of {uv_size} texels a side")


@contextmanager
def _opened(path: Path) -> Iterator[tuple[BufferedReader, int]]:
    """The open file and its size; every failure in it names the path."""
    try:
        with open_ordinary(path) as opened:
            yield opened
    except GemFormatError as error:
        raise error.at(path) from None
    except OSError as error:
        raise GemFormatError(f"cannot be read ({error.strerror})", "check the path", str(path)) from error
