"""kill -9 of evaluate and of refine at any moment: what was finished is whole, and the same command goes on."""

import json
import random
import subprocess
import time
from pathlib import Path
from typing import Any

import psutil
import pytest

pytest.importorskip("torch", reason="evaluating needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.models.gemfile import load_gem
from gemheads.models.wholefile import file_sha256
from killing import LONGEST, PYTHON, killed

from .conftest import Learned


def evaluation(avatar: Path, capture: Path, out: Path, *more: str) -> list[str]:
    return ["evaluate", str(avatar), str(capture), "-o", str(out), "--lpips", "none", "--shots", "3", *more]


def judged(out: Path) -> dict[str, Any]:
    """Key -> what is kept; raises where a file under its final name is not whole."""
    files = [path for path in (out / "judged").glob("*.json") if not path.name.startswith(".")]
    return {key: told for path in files for key, told in json.loads(path.read_text())["judged"].items()}


def tables(out: Path) -> dict[str, Any]:
    """The figures of a report, without what a clock says."""
    found = json.loads((out / "report.json").read_text())["tables"]
    for table in found.values():
        del table["seconds_to_find"]
    return found


def test_a_killed_evaluation_keeps_what_it_judged(learned: Learned, tmp_path: Path) -> None:
    capture, avatar, _ = learned
    rng, out, whole = random.Random(4), tmp_path / "killed", tmp_path / "whole"
    jobs = ("--jobs", "1"), ("--jobs", "2")
    before: dict[str, Any] = {}
    for more in jobs:
        words = evaluation(avatar, capture, out, *more)
        found = killed(words, lambda: any((out / "judged").glob("*")), rng.uniform(0.0, 0.5))
        kept = judged(out)
        assert {key: kept.get(key) for key in before} == before  # nothing that was judged is lost, or done again
        if (out / "report.json").exists():  # it was done just before
            assert len(tables(out)) == 2
        before = kept
        _, alive = psutil.wait_procs(found.children, timeout=LONGEST)
        assert not alive, "a process that judged outlived its parent"
    assert before
    assert main(evaluation(avatar, capture, out, "--jobs", "1")) == ExitCode.OK
    assert main(evaluation(avatar, capture, whole, "--jobs", "1")) == ExitCode.OK
    assert tables(out) == tables(whole)
    after = judged(out)
    assert {key: after[key] for key in before} == before


def test_a_killed_refinement_leaves_the_old_avatar_or_the_new_one(learned: Learned, tmp_path: Path) -> None:
    """Over itself, where a half-written file would be the loss of the avatar."""
    capture, avatar, track = learned
    rng, path = random.Random(5), tmp_path / "toy.gem"
    start = ("--start", str(track), "--iterations", "10", "--no-perceptual")
    words = ["refine", str(path), str(capture), *start]
    path.write_bytes(avatar.read_bytes())
    began = time.monotonic()
    subprocess.run(PYTHON + words, check=True, capture_output=True, timeout=LONGEST)
    took = time.monotonic() - began
    versions = {file_sha256(avatar), file_sha256(path)}
    assert len(versions) == 2
    for share in (rng.uniform(0.3, 0.9), rng.uniform(0.9, 1.0)):
        path.write_bytes(avatar.read_bytes())
        with subprocess.Popen(PYTHON + words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            time.sleep(share * took)
            process.kill()
        assert file_sha256(path) in versions
        assert len(load_gem(path)) == len(load_gem(avatar))
    path.write_bytes(avatar.read_bytes())
    assert main(words) == ExitCode.OK
    assert file_sha256(path) == max(versions - {file_sha256(avatar)})  # wherever it goes on, it comes to the same
    assert [file.name for file in tmp_path.iterdir()] == ["toy.gem"]
