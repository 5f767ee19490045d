"""Coefficient tracks: a performance as one safetensors file, to be played again without its video."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.brevity import brief
from ...models.wholefile import write_whole
from ..errors import InputError
from ..files.places import save_learned
from ..files.tensorfile import read_json, read_ratio, read_tensor_file
from .performance import Pose
from .presence import Phase

FORMAT = "gemheads-track"
VERSION = 3
"""Version 1 knows no ``translation``: there the head is where it rests; 1 and 2 do not say where a scene begins."""
MAX_TURN = 7.0
"""Radians about each axis: once around."""
MAX_TRANSLATION_M = 100.0
"""A head farther from its place than this is a mistake in somebody's units."""
MAX_BYTES = 2**30
MAX_FRAMES = 2**20
"""Four hours at 60 frames a second."""
MAX_PTS = 2**53
MAX_RATE = 1000
_TENSORS = {
    1: ("pts", "coefficients", "turn", "phase", "faces", "clamped"),
    2: ("pts", "coefficients", "turn", "translation", "phase", "faces", "clamped"),
    3: ("pts", "coefficients", "turn", "translation", "phase", "faces", "clamped", "cut"),
}
"""Version -> what is in it."""


@dataclass(frozen=True)
class Track:
    """What an avatar does over time."""

    avatar: str
    avatar_sha256: str
    """Coefficients mean something only to the file they were made for."""
    time_base: Fraction
    rate: Fraction
    pts: NDArray[np.int64]
    """[F] presentation times in units of ``time_base``, rising."""
    poses: tuple[Pose, ...]
    driver_sha256: str = ""
    """Of what was tracked, as credentials say it; empty where nobody knows, as in tracks of before."""

    @property
    def frame_count(self) -> int:
        """F."""
        return len(self.poses)

    def __iter__(self) -> Iterator[tuple[None, Pose, int]]:
        for pose, pts in zip(self.poses, self.pts, strict=True):
            yield None, pose, int(pts)


def head_still(track: Track) -> Track:
    """The same expressions with the head in its place."""
    still = np.zeros(3, np.float32)
    return replace(track, poses=tuple(replace(pose, turn=still, translation=still) for pose in track.poses))


def save_track(track: Track, path: Path) -> None:
    """Write the track. Raises OutputError."""
    from safetensors.numpy import save

    tensors = {
        "pts": track.pts,
        "coefficients": np.stack([pose.coefficients for pose in track.poses]),
        "turn": np.stack([pose.turn for pose in track.poses]),
        "translation": np.stack([pose.translation for pose in track.poses]),
        "phase": np.array([pose.phase.value for pose in track.poses], np.uint8),
        "faces": np.array([pose.faces for pose in track.poses], np.uint8),
        "clamped": np.array([pose.clamped for pose in track.poses], np.float32),
        "cut": np.array([pose.cut for pose in track.poses], np.bool_),
    }
    about = {
        "version": VERSION,
        "avatar": track.avatar,
        "avatar_sha256": track.avatar_sha256,
        "driver_sha256": track.driver_sha256,
        "time_base": str(track.time_base),
        "rate": str(track.rate),
    }
    content = save(tensors, {FORMAT: json.dumps(about, sort_keys=True)})

    def write(place: Path) -> None:
        place.parent.mkdir(parents=True, exist_ok=True)
        write_whole(place, [content])

    save_learned(write, path)


def load_track(path: Path) -> Track:
    """Read a track. Raises InputError, which says what is wrong, for anything that ``save_track`` did not write."""
    try:
        metadata, tensors = read_tensor_file(path, MAX_BYTES)
        return _checked(read_json(metadata.get(FORMAT, "null")), tensors)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the path") from error
    except (ValueError, KeyError) as error:
        raise InputError(
            f"{path}: not a track ({brief(error)}); make one with `gemheads track DRIVER -o FILE`"
        ) from error


def _checked(about: object, tensors: dict[str, NDArray[np.generic]]) -> Track:
    version = about.get("version") if isinstance(about, dict) else None
    if not isinstance(about, dict) or not isinstance(version, int) or version not in _TENSORS:
        raise ValueError(f"no {FORMAT} of version 1 to {VERSION}")
    if set(tensors) != set(_TENSORS[version]):
        raise ValueError(f"tensors {sorted(tensors)}, expected {sorted(_TENSORS[version])}")
    if tensors["pts"].ndim != 1 or tensors["coefficients"].ndim != 2:
        raise ValueError("pts must be [F] and coefficients [F, n]")
    frames, width = tensors["coefficients"].shape
    shapes = {"coefficients": (width,), "turn": (3,), "translation": (3,)}
    kinds = {"pts": np.int64, "phase": np.uint8, "faces": np.uint8, "cut": np.bool_}
    for name, values in tensors.items():
        if values.shape != (frames, *shapes.get(name, ())) or values.dtype != kinds.get(name, np.float32):
            raise ValueError(f"tensor {name} is {values.dtype}{list(values.shape)}")
        if values.dtype == np.float32 and not np.isfinite(values).all():
            raise ValueError(f"tensor {name} has values that are not finite")
    cut = tensors.get("cut", np.zeros(frames, np.bool_))
    translation = np.asarray(tensors.get("translation", np.zeros((frames, 3))), np.float32)
    if (np.abs(translation) > MAX_TRANSLATION_M).any():
        raise ValueError(f"tensor translation moves the head by more than {MAX_TRANSLATION_M:g} m")
    if (np.abs(tensors["turn"].astype(np.float64)) > MAX_TURN).any():
        raise ValueError(f"tensor turn turns the head by more than {MAX_TURN:g} radians")
    pts = tensors["pts"].astype(np.int64)
    # compared, not subtracted: a difference of such numbers may wrap around
    if frames == 0 or (pts[1:] <= pts[:-1]).any() or np.abs(pts.astype(np.float64)).max() > MAX_PTS:
        raise ValueError("no frames, or times that do not rise or are out of all bounds")
    if frames > MAX_FRAMES:
        raise ValueError(f"{frames} frames are more than the {MAX_FRAMES} that are read")
    time_base, rate = read_ratio(about["time_base"]), read_ratio(about["rate"])
    if rate > MAX_RATE:
        raise ValueError(f"a rate above {MAX_RATE} frames a second")
    poses = tuple(
        Pose(
            np.asarray(tensors["coefficients"][i], np.float32),
            np.asarray(tensors["turn"][i], np.float32),
            Phase(int(tensors["phase"][i])),
            int(tensors["faces"][i]),
            float(tensors["clamped"][i]),
            bool(cut[i]),
            translation=translation[i],
        )
        for i in range(frames)
    )
    driver = str(about.get("driver_sha256", ""))
    return Track(str(about["avatar"]), str(about["avatar_sha256"]), time_base, rate, pts, poses, driver)
