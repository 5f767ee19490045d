"""What the commands of these tests work on."""

from pathlib import Path
from typing import NamedTuple

import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode


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
