"""Performances in ARKit weights as one safetensors file: any avatar with an ARKit map can play them."""

import json
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.arkit import NAMES
from ...models.brevity import brief
from ...models.wholefile import open_ordinary, write_whole
from ..errors import InputError, cannot_write
from ..files.tensorfile import read_json, read_ratio, read_tensor_file

FORMAT = "gemheads-weights"
VERSION = 1
SHIPPED = Path(__file__).resolve().parents[2] / "assets" / "demo" / "performance.safetensors"
"""The performance that ships."""
MAX_BYTES = 2**28
MAX_TURN = 1.6
"""Radians: no head turns further."""
_TENSORS = {"pts": (np.int64, ()), "weights": (np.float32, (len(NAMES),)), "turn": (np.float32, (3,))}


@dataclass(frozen=True)
class WeightsTrack:
    """What a face does over time, whoever's it is."""

    name: str
    """For people; 1 to 80 characters."""
    time_base: Fraction
    """Seconds per unit of ``pts``."""
    pts: NDArray[np.int64]
    """[F] presentation times, rising."""
    weights: NDArray[np.float32]
    """[F, 52] in [0, 1], order of ``arkit.NAMES``."""
    turn: NDArray[np.float32]
    """[F, 3] rotation of the head from its rest, axis and angle in radians."""


def is_weights(path: Path) -> bool:
    """Whether the file says that it is one of these; it may still be broken. Raises InputError if it cannot be read."""
    try:
        with open_ordinary(path) as (file, _):
            return FORMAT.encode() in file.read(4096)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the path") from error


def save_weights(track: WeightsTrack, path: Path) -> None:
    """Write the performance. Raises OutputError, or ValueError for what ``load_weights`` would refuse."""
    from safetensors.numpy import save

    tensors = {"pts": track.pts, "weights": track.weights, "turn": track.turn}
    about = {"version": VERSION, "name": track.name, "time_base": str(track.time_base)}
    _checked(about, tensors)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, [save(tensors, {FORMAT: json.dumps(about, sort_keys=True)})])
    except OSError as error:
        raise cannot_write(path, error) from error


def load_weights(path: Path) -> WeightsTrack:
    """Read a performance. Raises InputError, which says what is wrong, for what ``save_weights`` did not write."""
    try:
        metadata, tensors = read_tensor_file(path, MAX_BYTES)
        return _checked(read_json(metadata[FORMAT]), tensors)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the path") from error
    except (ValueError, KeyError) as error:
        raise InputError(f"{path}: not a performance in ARKit weights ({brief(error)}); give another file") from error


def _checked(about: object, tensors: dict[str, NDArray[np.generic]]) -> WeightsTrack:
    if not isinstance(about, dict) or about.get("version") != VERSION:
        raise ValueError(f"no {FORMAT} of version {VERSION}")
    if set(tensors) != set(_TENSORS):
        raise ValueError(f"tensors {sorted(tensors)}, expected {sorted(_TENSORS)}")
    for name, (kind, shape) in _TENSORS.items():
        if tensors[name].dtype != kind or tensors[name].shape != (tensors["pts"].size, *shape):
            raise ValueError(f"tensor {name} is {tensors[name].dtype}{list(tensors[name].shape)}")
    pts = tensors["pts"].astype(np.int64)
    weights, turn = (tensors[name].astype(np.float32) for name in ("weights", "turn"))
    if not (np.isfinite(weights).all() and (weights >= 0).all() and (weights <= 1).all()):
        raise ValueError("weights outside 0..1")
    if not (np.isfinite(turn).all() and (np.linalg.norm(turn, axis=1) <= MAX_TURN).all()):
        raise ValueError(f"the head turns further than {MAX_TURN} radians")
    if len(pts) == 0 or (pts[1:] <= pts[:-1]).any():
        raise ValueError("no frames, or times that do not rise")
    name, time_base = str(about["name"]), read_ratio(about["time_base"])
    if not 0 < len(name) <= 80 or time_base > 1:
        raise ValueError("a name of 1 to 80 characters and a time base above 0 are needed")
    return WeightsTrack(name, time_base, pts, weights, turn)
