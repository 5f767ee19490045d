"""The way from a capture to an avatar: on a full disk, into a barred folder, without a network, killed."""

import errno
import json
import os
import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from answers import BYTES, Answer, run
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.models.captures.reader import open_capture
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem, save_gem
from killing import killed
from sealed import seal

from .conftest import Learned

Answers = dict[str, Answer]
LARGE = ("capture", "distill", "train", "refine", "evaluate")
"""Commands that write more than a full disk takes."""


def commands(learned: Learned, out: Path) -> dict[str, list[str]]:
    """Name -> words of a small run."""
    capture, avatar, track = (str(path) for path in learned)
    start = ["--start", track, "--iterations", "10", "--no-perceptual"]
    judged = ["--lpips", "none", "--shots", "1", "-o"]
    return {
        "capture": ["capture", str(out / "ada"), "--cameras", "2", "--size", "48x32", "--split", "1+1"],
        "distill": ["distill", capture, "-o", str(out / "distilled.gem"), "--maps", "16", "--components", "4"],
        "train": ["train", capture, "-o", str(out / "run"), "--steps", "2", "--no-perceptual"],
        "refine": ["refine", avatar, capture, "-o", str(out / "refined.gem"), *start],
        "fit": ["fit", avatar, capture, "-o", str(out / "fit.track"), "--split", "val", "--cameras", "4"],
        "evaluate": ["evaluate", avatar, capture, "--jobs", "1", *judged, str(out / "report")],
        "evaluate by several": ["evaluate", avatar, capture, "--jobs", "2", *judged, str(out / "by several")],
    }


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    return tmp_path_factory.mktemp


@pytest.fixture(scope="module")
def full(learned: Learned, place: Callable[[str], Path]) -> tuple[Path, Answers]:
    """A folder on a full disk, and what the commands said."""
    out = place("full")
    given = commands(learned, out)
    return out, run(BYTES, {name: given[name] for name in LARGE})


@pytest.mark.parametrize("name", LARGE)
def test_a_full_disk_is_told(full: tuple[Path, Answers], name: str) -> None:
    assert full[1][name].error()


def test_a_full_disk_leaves_nothing_that_looks_whole(full: tuple[Path, Answers]) -> None:
    left = {path.name for path in full[0].rglob("*") if path.is_file()}
    assert not {"transforms_train.json", "distilled.gem", "checkpoint.pt", "refined.gem", "report.html"} & left
    assert not [name for name in left if name.endswith(".partial")]


@pytest.fixture(scope="module")
def barred(learned: Learned, place: Callable[[str], Path]) -> Answers:
    """A file stands where the folder should be."""
    file = place("barred") / "file"
    file.touch()
    given = commands(learned, file / "out")
    del given["evaluate by several"]
    return run(0, given)


@pytest.mark.parametrize("name", [*LARGE, "fit"])
def test_a_folder_that_cannot_be_written_is_told_before_hours_are_spent(barred: Answers, name: str) -> None:
    assert "file" in barred[name].error()
    assert "100%" not in barred[name].stderr


def test_a_refinement_is_kept_elsewhere_when_the_disk_has_become_full(
    learned: Learned, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(gem: Gem, path: Path) -> None:
        if path.parent == tmp_path:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        save_gem(gem, path)

    monkeypatch.setattr("gemheads.app.making.refining.save_gem", full)
    avatar = tmp_path / "toy.gem"
    avatar.write_bytes(learned.avatar.read_bytes())
    words = ["refine", str(avatar), str(learned.capture), "--start", str(learned.track), "--iterations", "10"]
    assert main([*words, "--no-perceptual"]) == ExitCode.OUTPUT
    (kept,) = re.findall(r"kept as (\S+):", capsys.readouterr().err)
    assert len(load_gem(Path(kept))) == len(load_gem(avatar))
    assert avatar.read_bytes() == learned.avatar.read_bytes()


def test_no_command_opens_a_socket(learned: Learned, place: Callable[[str], Path]) -> None:
    """Not in native libraries either, nor in processes that it starts."""
    answers = run(0, commands(learned, place("sealed")), seal())
    assert {name: answer.stderr for name, answer in answers.items() if answer.code} == {}


def test_a_killed_capture_goes_on_to_the_same(learned: Learned, place: Callable[[str], Path]) -> None:
    rng, out = random.Random(6), place("killed")
    whole = commands(learned, out / "whole")["capture"]
    words = commands(learned, out / "killed")["capture"]
    first = out / "killed" / "ada" / "images" / "00000_00.png"
    assert killed(words, first.exists, rng.uniform(0, 0.05)).in_time
    with pytest.raises(Exception, match="transforms_train"):
        open_capture(out / "killed" / "ada")
    for name, answer in run(0, {"whole": whole, "gone on with": words}).items():
        assert answer.code == 0, (name, answer.stderr)
    files = {path.relative_to(out / "whole"): path for path in (out / "whole").rglob("*") if path.is_file()}
    for name, path in files.items():
        assert (out / "killed" / name).read_bytes() == path.read_bytes(), name
    assert json.loads((out / "killed" / "ada" / "transforms_train.json").read_text())["frames"]
