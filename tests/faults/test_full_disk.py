"""The disk is full, or the folder cannot be written: commands say so in one line with exit code 5; nothing is lost."""

import json
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest
from sealed import skip_where_refused

from .test_killed_commands import played

if sys.platform == "win32":
    pytest.skip("limits on file sizes are set by POSIX calls", allow_module_level=True)
__all__ = ["played"]

BYTES = 20_000
"""From here on the disk is full."""
PROGRAM = """
import contextlib, io, json, resource, signal, sys
from gemheads.app.cli import main

if int(sys.argv[1]):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
answers = {}
for name, words in json.load(sys.stdin).items():
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        answers[name] = [main(words), said.getvalue()]
print(json.dumps(answers))
"""
NAMES = ("export", "export --track", "modes", "reenact to mp4", "reenact to a folder", "distill", "train-regressor")


class Answer(NamedTuple):
    """What a command said."""

    code: int
    stderr: str

    def error(self) -> str:
        """Its one line."""
        errors = [line for line in self.stderr.splitlines() if line.startswith("error: ")]
        assert self.code == 5, self.stderr
        assert len(errors) == 1, self.stderr
        assert "unexpected" not in errors[0]
        assert ";" in errors[0]  # what, and the cure
        return errors[0]


def run(limit: int, commands: dict[str, list[str]], first: str = "") -> dict[str, Answer]:
    """All of them in one process, which begins with ``first``; no file may grow beyond ``limit`` bytes."""
    program = [sys.executable, "-c", first + PROGRAM, str(limit)]
    given = json.dumps(commands)
    done = subprocess.run(program, input=given, capture_output=True, text=True, timeout=120, check=False)
    skip_where_refused(done)
    assert done.returncode == 0, done.stderr
    return {name: Answer(*answer) for name, answer in json.loads(done.stdout.splitlines()[-1]).items()}


def commands(played: tuple[Path, Path], frames: Path, out: Path) -> dict[str, list[str]]:
    """Name -> words."""
    avatar, track = (str(path) for path in played)
    acting = ["reenact", "--avatar", avatar, "--track", track, "--engine", "software", "--size", "320x320", "-o"]
    words = (
        ["export", avatar, "-o", str(out / "a.ply")],
        ["export", avatar, "--track", track, "-o", str(out / "plys")],
        ["modes", avatar, "-o", str(out / "modes.png"), "--engine", "software"],
        [*acting, str(out / "a.mp4")],
        [*acting, str(out / "pictures"), "--background", "transparent"],
        ["distill", str(frames), "-o", str(out / "a.gem"), "--components", "2"],
        ["train-regressor", avatar, "-o", str(out / "b.gem"), "--pictures", "40", "--steps", "1"],
    )
    return dict(zip(NAMES, words, strict=True))


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory, played: tuple[Path, Path]) -> Path:
    """What distill reads."""
    folder = tmp_path_factory.mktemp("frames")
    answers = run(0, {name: ["export", str(played[0]), "-o", str(folder / f"{name}.ply")] for name in "12"})
    assert all(answer.code == 0 for answer in answers.values())
    return folder


@pytest.fixture(scope="module")
def full(
    tmp_path_factory: pytest.TempPathFactory, played: tuple[Path, Path], frames: Path
) -> tuple[Path, dict[str, Answer]]:
    """A folder on a full disk, with a file that was there before, and what the commands said."""
    out = tmp_path_factory.mktemp("full")
    (out / "a.ply").write_bytes(b"what was there before")
    given = commands(played, frames, out)
    return out, run(BYTES, {name: given[name] for name in NAMES[:-1]})


@pytest.fixture(scope="module")
def barred(tmp_path_factory: pytest.TempPathFactory, played: tuple[Path, Path], frames: Path) -> dict[str, Answer]:
    """A file stands where the folder should be: nobody may write there, not even an administrator."""
    place = tmp_path_factory.mktemp("barred") / "file"
    place.touch()
    return run(0, commands(played, frames, place / "out"))


@pytest.mark.parametrize("name", NAMES[:-1])  # what a training has to write is not much
def test_a_full_disk_is_told(full: tuple[Path, dict[str, Answer]], name: str) -> None:
    assert full[1][name].error()


def test_a_full_disk_leaves_nothing_that_looks_whole(full: tuple[Path, dict[str, Answer]]) -> None:
    out = full[0]
    assert (out / "a.ply").read_bytes() == b"what was there before"
    left = {path.name for path in out.iterdir() if path.is_file()}
    assert left <= {"a.ply", "a.partial.mp4"}
    assert not (out / "pictures" / "times.csv").exists()


@pytest.mark.parametrize("name", NAMES)
def test_a_folder_that_cannot_be_written_is_told(barred: dict[str, Answer], name: str) -> None:
    assert "file" in barred[name].error()
