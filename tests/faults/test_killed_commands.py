"""kill -9 at any moment of a command: what it had finished is whole, and it can be started again."""

import os
import random
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.files.sinks import is_whole
from gemheads.app.files.sources import read_image
from gemheads.app.files.video import VideoFile
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, save_track
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.models.wholefile import file_sha256

from .writers import avatar

PYTHON = [sys.executable, "-m", "gemheads.app.cli"]
FRAMES = 90
LATEST = 0.3
"""Seconds after the first trace of a result at which it is killed at the latest."""


@pytest.fixture(scope="module")
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


def command(played: tuple[Path, Path], out: Path, *more: str) -> list[str]:
    words = ["reenact", "--avatar", str(played[0]), "--track", str(played[1]), "-o", str(out), "--engine", "software"]
    return [*PYTHON, *words, "--size", "128x128", *more]


def killed(words: list[str], begun: Path, secs: float) -> bool:
    """Whether the command was killed, so long after ``begun`` appeared, before it was done."""
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while not begun.exists() and process.poll() is None:
            time.sleep(0.005)
        time.sleep(secs)
        process.kill()
        return process.wait() != 0


def run(words: list[str]) -> str:
    done = subprocess.run(words, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_a_killed_reenactment_is_never_taken_for_a_whole_one(played: tuple[Path, Path], tmp_path: Path) -> None:
    rng = random.Random(2)
    kills = 0
    for number in range(3):
        out, partial = tmp_path / f"{number}.mp4", tmp_path / f"{number}.partial.mp4"
        killed(command(played, out), partial, rng.uniform(0, LATEST))
        if out.exists():  # it was done, or just about to leave
            assert len(list(VideoFile(out).frames())) == FRAMES
        else:
            kills += 1
            assert not is_whole(out)
    assert kills
    run(command(played, out, "--resume"))  # begins again, or leaves what is whole
    assert len(list(VideoFile(out).frames())) == FRAMES
    assert not partial.exists()


def test_a_killed_folder_of_pictures_is_continued(played: tuple[Path, Path], tmp_path: Path) -> None:
    out, first = tmp_path / "killed", tmp_path / "killed" / "frame_000003.png"
    assert killed(command(played, out), first, 0.05)
    assert not is_whole(out)
    before = {file.name: file.stat().st_mtime_ns for file in out.glob("*.png")}
    run(command(played, out, "--resume"))
    run(command(played, tmp_path / "whole"))
    assert is_whole(out)
    assert (out / "times.csv").read_text() == (tmp_path / "whole" / "times.csv").read_text()
    for index in range(FRAMES):
        name = f"frame_{index:06d}.png"
        np.testing.assert_array_equal(read_image(out / name), read_image(tmp_path / "whole" / name))
    kept = [name for name, time_ns in before.items() if (out / name).stat().st_mtime_ns == time_ns]
    assert kept == list(before)  # nothing was drawn twice
    assert 3 <= len(kept) < FRAMES


def test_a_killed_training_leaves_the_avatar_as_it_was(played: tuple[Path, Path], tmp_path: Path) -> None:
    pytest.importorskip("torch")
    path = tmp_path / "avatar.gem"
    path.write_bytes(played[0].read_bytes())
    words = [*PYTHON, "train-regressor", str(path), "--pictures", "300", "--steps", "50"]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    with subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        time.sleep(random.Random(3).uniform(2.0, 5.0))
        process.kill()
    assert path.read_bytes() == played[0].read_bytes()
    assert load_gem(path).regressor is None
