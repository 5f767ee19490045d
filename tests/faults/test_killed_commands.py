"""kill -9 at any moment of a command: what it had finished is whole, and it can be started again."""

import random
import subprocess
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.files.sinks import is_whole
from gemheads.app.files.sources import read_image
from gemheads.app.files.video import VideoFile
from gemheads.models.wholefile import file_sha256
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
        out, unfinished = tmp_path / f"{number}.mp4", tmp_path / f"{number}.partial.mp4"
        killed(command(played, out), unfinished.exists, rng.uniform(0, LATEST))
        if out.exists():  # it was done, or just about to leave
            assert len(list(VideoFile(out).frames())) == FRAMES
        else:
            kills += 1
            assert not is_whole(out)
    assert kills
    run(command(played, out, "--resume"))  # begins again, or leaves what is whole
    assert len(list(VideoFile(out).frames())) == FRAMES
    assert not unfinished.exists()


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
    """Or as it was to become: it takes over what another has learned, learns nothing, and writes as all others do."""
    pytest.importorskip("torch", reason="training needs the extra gemheads[train]")
    path, words = tmp_path / "avatar.gem", ["train-regressor", str(tmp_path / "avatar.gem"), "--take-over", "mara"]
    path.write_bytes(played[0].read_bytes())
    run(words)
    versions = {file_sha256(played[0]), file_sha256(path)}
    assert len(versions) == 2
    rng = random.Random(3)
    kills = 0
    for _ in range(3):
        for left in tmp_path.iterdir():
            left.unlink()
        path.write_bytes(played[0].read_bytes())
        before = path.stat()
        begun = partial(changed, path, before.st_ino, before.st_mtime_ns)
        kills += killed(words, begun, rng.uniform(0, 0.01)).in_time
        assert file_sha256(path) in versions
    assert kills


def changed(path: Path, inode: int, time_ns: int) -> bool:
    """Whether it is another file now, or was written to, or something stands beside it."""
    status = path.stat()
    return (status.st_ino, status.st_mtime_ns) != (inode, time_ns) or len(list(path.parent.iterdir())) > 1
