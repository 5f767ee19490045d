"""Coefficient tracks: a performance as one safetensors file, to be played again without its video."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..models.wholefile import write_whole
from .errors import InputError, OutputError
from .performance import Pose
from .state import Phase

FORMAT = "gemheads-track"
VERSION = 2
"""Version 1 knows no ``translation``: there the head is where it rests."""
MAX_TRANSLATION_M = 100.0
"""A head farther from its place than this is a mistake in somebody's units."""
MAX_BYTES = 2**30
_TENSORS = {
    1: ("pts", "coefficients", "turn", "phase", "faces", "clamped"),
    2: ("pts", "coefficients", "turn", "translation", "phase", "faces", "clamped"),
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

    @property
    def frame_count(self) -> int:
        """F."""
        return len(self.poses)

    def __iter__(self) -> Iterator[tuple[None, Pose, int]]:
        for pose, pts in zip(self.poses, self.pts, strict=True):
            yield None, pose, int(pts)


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
    }
    about = {
        "version": VERSION,
        "avatar": track.avatar,
        "avatar_sha256": track.avatar_sha256,
        "time_base": str(track.time_base),
        "rate": str(track.rate),
    }
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, [save(tensors, {FORMAT: json.dumps(about, sort_keys=True)})])
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror}); check the folder") from error


def load_track(path: Path) -> Track:
    """Read a track. Raises InputError, which says what is wrong, for anything that ``save_track`` did not write."""
    from safetensors import SafetensorError, safe_open

    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(
                f"{path}: larger than {MAX_BYTES >> 20} MB, as no track is; give a file of `gemheads track`"
            )
        with safe_open(str(path), framework="numpy") as file:
            about = json.loads((file.metadata() or {}).get(FORMAT, "null"))
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (no mapping)
        return _checked(about, tensors)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the path") from error
    except (SafetensorError, ValueError, KeyError, TypeError, ZeroDivisionError) as error:
        raise InputError(f"{path}: not a track ({error}); make one with `gemheads track DRIVER -o FILE`") from error


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
    kinds = {"pts": np.int64, "coefficients": np.float32, "turn": np.float32, "phase": np.uint8, "faces": np.uint8}
    for name, values in tensors.items():
        if values.shape != (frames, *shapes.get(name, ())) or values.dtype != kinds.get(name, np.float32):
            raise ValueError(f"tensor {name} is {values.dtype}{list(values.shape)}")
        if values.dtype == np.float32 and not np.isfinite(values).all():
            raise ValueError(f"tensor {name} has values that are not finite")
    translation = np.asarray(tensors.get("translation", np.zeros((frames, 3))), np.float32)
    if (np.abs(translation) > MAX_TRANSLATION_M).any():
        raise ValueError(f"tensor translation moves the head by more than {MAX_TRANSLATION_M:g} m")
    pts = tensors["pts"].astype(np.int64)
    if frames == 0 or (np.diff(pts) <= 0).any():
        raise ValueError("no frames, or times that do not rise")
    time_base, rate = Fraction(about["time_base"]), Fraction(about["rate"])
    if time_base <= 0 or rate <= 0:
        raise ValueError("time base and rate must be above 0")
    poses = tuple(
        Pose(
            np.asarray(tensors["coefficients"][i], np.float32),
            np.asarray(tensors["turn"][i], np.float32),
            Phase(int(tensors["phase"][i])),
            int(tensors["faces"][i]),
            float(tensors["clamped"][i]),
            translation=translation[i],
        )
        for i in range(frames)
    )
    return Track(str(about["avatar"]), str(about["avatar_sha256"]), time_base, rate, pts, poses)
