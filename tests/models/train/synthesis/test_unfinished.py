"""What a refinement keeps beside its result is gone when it is finished, also what killed runs left of it."""

from pathlib import Path

import pytest

pytest.importorskip("torch", reason="refining needs the extra gemheads[train]")

from gemheads.models.train.synthesis.unfinished import Unfinished


def test_nothing_is_left_of_runs_that_were_killed_while_they_wrote(tmp_path: Path) -> None:
    unfinished = Unfinished(tmp_path / ".toy.gem.unfinished", "this one")
    unfinished.write({"done": 3})
    (tmp_path / "..toy.gem.unfinished.4711.partial").write_bytes(b"half")
    for name in ("toy.gem", ".toy.gem.4711.partial", "..other.gem.unfinished.4711.partial"):
        (tmp_path / name).write_bytes(b"somebody else's")
    unfinished.remove()
    left = {".toy.gem.4711.partial", "..other.gem.unfinished.4711.partial", "toy.gem"}
    assert {file.name for file in tmp_path.iterdir()} == left
