"""What the commands of these tests work on."""

from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from answers import run
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, save_track
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.models.wholefile import file_sha256

from .writers import avatar

FRAMES = 90
"""Frames of the track that is played."""


class Learned(NamedTuple):
    """A capture, the avatar of its bare mesh, and what that does at the capture's moments."""

    capture: Path
    avatar: Path
    track: Path


@pytest.fixture(scope="session")
def learned(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> Learned:
    """Small ones. Skips where torch is missing, which learning needs."""
    pytest.importorskip("torch", reason="learning needs the extra gemheads[train]")
    path = tmp_path_factory.mktemp("learned") / "toy.gem"
    words = ("--maps", "16", "--components", "2", "--moments", str(path.with_suffix(".track")))
    assert main(["distill", str(toy_capture), "-o", str(path), *words]) == ExitCode.OK
    return Learned(toy_capture, path, path.with_suffix(".track"))


@pytest.fixture(scope="session")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """An avatar, and a track of FRAMES frames for it."""
    folder = tmp_path_factory.mktemp("played")
    save_gem(avatar(), folder / "avatar.gem")
    gem = load_gem(folder / "avatar.gem")
    poses = tuple(
        Pose(np.sin(0.1 * frame + np.arange(gem.coefficient_count)).astype(np.float32), np.zeros(3, np.float32))
        for frame in range(FRAMES)
    )
    sha256 = file_sha256(folder / "avatar.gem")
    track = Track(gem.name, sha256, Fraction(1, 30), Fraction(30), np.arange(FRAMES), poses)
    save_track(track, folder / "track.safetensors")
    return folder / "avatar.gem", folder / "track.safetensors"


@pytest.fixture(scope="session")
def frames(tmp_path_factory: pytest.TempPathFactory, played: tuple[Path, Path]) -> Path:
    """What distill reads."""
    folder = tmp_path_factory.mktemp("frames")
    answers = run(0, {name: ["export", str(played[0]), "-o", str(folder / f"{name}.ply")] for name in "12"})
    assert all(answer.code == 0 for answer in answers.values())
    return folder
