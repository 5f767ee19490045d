"""kill -9 at any moment of a command: what it had finished is whole, and it can be started again."""

import os
import random
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.files.sinks import is_whole
from gemheads.app.files.sources import read_image
from gemheads.app.files.video import VideoFile
from gemheads.models.gemfile import load_gem
from killing import PYTHON, killed

from .conftest import FRAMES

LATEST = 0.3
"""Seconds after the first trace of a result at which it is killed at the latest."""


def command(played: tuple[Path, Path], out: Path, *more: str) -> list[str]:
    words = ["reenact", "--avatar", str(played[0]), "--track", str(played[1]), "-o", str(out), "--engine", "software"]
    return [*words, "--size", "128x128", *more]


def run(words: list[str]) -> str:
    done = subprocess.run([*PYTHON, *words], capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def test_a_killed_reenactment_is_never_taken_for_a_whole_one(played: tuple[Path, Path], tmp_path: Path) -> None:
    rng = random.Random(2)
    kills = 0
    for number in range(3):
        out, partial = tmp_path / f"{number}.mp4", tmp_path / f"{number}.partial.mp4"
        killed(command(played, out), partial.exists, rng.uniform(0, LATEST))
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
    assert killed(command(played, out), first.exists, 0.05).in_time
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
