"""Moments of a capture as a track: what an avatar does at each timestep, for `refine`, `train-regressor`, `reenact`."""

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..performing.casting import Avatar
from ..performing.performance import Pose
from ..performing.tracks import Track, load_track, save_track

RATE = Fraction(30)
"""Timesteps a second when the track is played; a capture does not say."""


def save_moments(name: str, sha256: str, moments: Mapping[int, Pose], out: Path) -> None:
    """Write a track whose times are the capture's timesteps. Raises OutputError."""
    times = sorted(moments)
    poses = tuple(moments[time] for time in times)
    save_track(Track(name, sha256, 1 / RATE, RATE, np.array(times, np.int64), poses), out)


def load_moments(path: Path, avatar: Avatar) -> dict[int, Pose]:
    """Timestep -> what the avatar does then. Raises InputError for another avatar's track, and for none."""
    track = load_track(path)
    if track.avatar_sha256 != avatar.sha256:
        raise InputError(f"{path}: was made for another avatar ('{track.avatar}'); give the one of {avatar.path}")
    return dict(zip(track.pts.tolist(), track.poses, strict=True))
