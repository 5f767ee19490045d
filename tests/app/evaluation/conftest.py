"""What is judged here and in more than one file."""

from pathlib import Path

import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode


@pytest.fixture(scope="package")
def run(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run") / "cnn"
    assert main(["train", str(toy_capture), "-o", str(folder), "--steps", "2", "--no-perceptual"]) == ExitCode.OK
    return folder
