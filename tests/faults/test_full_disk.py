"""The disk is full, or the folder cannot be written: commands say so in one line with exit code 5; nothing is lost."""

import sys
from pathlib import Path

import pytest
from answers import BYTES, Answer, run

from .runs import NAMES, commands

if sys.platform == "win32":
    pytest.skip("limits on file sizes are set by POSIX calls", allow_module_level=True)


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
