"""Runs of strangers: a checkpoint that is a program, and a plan that would fill the memory."""

import io
import json
import pickle
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

torch = pytest.importorskip("torch", reason="runs need the extra gemheads[train]")

from gemheads.models.train.avatars.plan import PRESETS  # noqa: E402
from gemheads.models.train.avatars.runs import CHECKPOINT, CONFIG, RunError, read_checkpoint, read_config  # noqa: E402


class Program:
    """What a pickle may hold: a call of anything."""

    def __init__(self, victim: Path) -> None:
        self._victim = victim

    def __reduce__(self):
        return Path.unlink, (self._victim,)


@pytest.mark.parametrize("packed", [True, False])
def test_a_checkpoint_that_is_a_program_does_not_run(tmp_path: Path, packed: bool) -> None:
    victim = tmp_path / "victim"
    victim.touch()
    program = {"step": 1, "avatar": Program(victim)}
    if packed:
        torch.save(program, tmp_path / CHECKPOINT)
    else:
        (tmp_path / CHECKPOINT).write_bytes(pickle.dumps(program))
    with pytest.raises(RunError, match="is broken"):
        read_checkpoint(tmp_path)
    assert victim.exists()


def test_a_checkpoint_cut_off_anywhere(tmp_path: Path) -> None:
    whole = io.BytesIO()
    torch.save({"step": 1, "avatar": torch.zeros(100)}, whole)
    for end in range(0, len(whole.getvalue()) - 1, 97):
        (tmp_path / CHECKPOINT).write_bytes(whole.getvalue()[:end])
        with pytest.raises(RunError, match="is broken"):
            read_checkpoint(tmp_path)


@pytest.mark.parametrize("state", [[], {}, {"step": 1}, {"step": "x", "avatar": {}}, {"step": 1, "avatar": 3}])
def test_a_checkpoint_of_something_else(tmp_path: Path, state: object) -> None:
    torch.save(state, tmp_path / CHECKPOINT)
    with pytest.raises(RunError, match="is broken"):
        read_checkpoint(tmp_path)


def refused_config(folder: Path, text: str) -> None:
    (folder / CONFIG).write_text(text, errors="surrogateescape")
    with pytest.raises(RunError) as caught:
        read_config(folder)
    assert len(str(caught.value)) < len(str(folder)) + 400
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "[" * 100_000, "9" * 5000, '{"version": 1}', '{"version": {"a": []}}', "\udcff"]
)
def test_a_config_that_is_none(tmp_path: Path, text: str) -> None:
    refused_config(tmp_path, text)


@pytest.mark.parametrize(
    "changed", [{"steps": "x" * 50_000}, {"x" * 50_000: 1}, {"size": 2**40}, {"model": "os"}, {"width": 1e400}]
)
def test_a_plan_that_fills_the_memory_or_a_message(tmp_path: Path, changed: dict[str, Any]) -> None:
    told = {"version": 1, "capture": ".", "subject": "x", "seconds": 0, "plan": {**asdict(PRESETS["tiny"]), **changed}}
    refused_config(tmp_path, json.dumps(told))
