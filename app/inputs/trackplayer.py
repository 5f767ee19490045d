"""Tracks as a source: an avatar's own coefficients, or ARKit weights that any avatar can play."""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..library import REINSTALL
from ..performing.tracks import Track, load_track
from ..performing.weights import SHIPPED, WeightsTrack, is_weights, load_weights
from .player import Player
from .source import Delivery, PoseFrame, WeightsFrame

Clock = Callable[[], float]


def open_track(path: Path, clock: Clock = time.perf_counter) -> Player:
    """A track of either kind. Raises InputError, which says what is wrong with the file."""
    return play_weights(load_weights(path), clock) if is_weights(path) else play_track(load_track(path), clock)


def open_performance(clock: Clock = time.perf_counter) -> Player:
    """The performance that ships. Raises InputError where the installation is broken."""
    if not SHIPPED.is_file():
        raise InputError(f"{SHIPPED}: the performance that ships is missing; {REINSTALL}")
    return play_weights(load_weights(SHIPPED), clock)


def play_weights(track: WeightsTrack, clock: Clock = time.perf_counter) -> Player:
    """A performance in ARKit weights."""

    def deliver(index: int, seconds: float) -> Delivery:
        return WeightsFrame(track.weights[index], track.turn[index], seconds)

    return Player(track.name, "track", track.pts.astype(np.float64) * float(track.time_base), deliver, clock)


def play_track(track: Track, clock: Clock = time.perf_counter) -> Player:
    """A performance in the coefficients of one avatar."""

    def deliver(index: int, seconds: float) -> Delivery:
        return PoseFrame(track.poses[index], track.avatar_sha256, seconds)

    return Player(track.avatar, "track", track.pts.astype(np.float64) * float(track.time_base), deliver, clock)
