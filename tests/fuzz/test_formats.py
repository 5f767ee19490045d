"""A few mutations of every format each time, and that the machinery would notice."""

import os
from pathlib import Path

import pytest

from . import worker
from .formats import FORMATS, Format
from .runner import fuzz

SECONDS = 6.0
"""For each format, two minutes in all; the nightly command reads 100,000 of each, others every night."""
SEED = 11
"""Always the same here: a change is judged by what it changed, and luck is for the night."""


@pytest.mark.parametrize("name", FORMATS)
def test_what_is_mutated_opens_or_is_refused(name: str) -> None:
    found = fuzz(name, 100_000, seed=SEED, limit=SECONDS)
    assert not found.wrong, f"of {found.inputs} inputs: {found.wrong}"


@pytest.mark.parametrize("name", FORMATS)
def test_mutations_differ_and_come_again(name: str, tmp_path: Path) -> None:
    content = FORMATS[name].honest(tmp_path)
    made = [worker.made(name, content, 7, index) for index in range(40)]
    assert made == [worker.made(name, content, 7, index) for index in range(40)]
    assert len(set(made)) > 20
    assert any(one != content for one in made)


def _reading(read: object) -> Format:
    return Format(lambda _: b"", lambda content, rng: content, read, ValueError)  # pyright: ignore


def _refuse(path: Path) -> None:
    raise ValueError("no such thing")


def _torn(path: Path) -> None:
    raise KeyError("of nobody")


def _chatter(path: Path) -> None:
    raise ValueError("x" * 5000)


def _hoard(path: Path) -> None:
    bytearray(os.urandom(2**27))


@pytest.mark.parametrize(
    ("read", "wrong"), [(_refuse, ""), (_torn, "KeyError: 'of nobody'"), (_chatter, "5000 characters")]
)
def test_only_the_one_error_is_let_through(read: object, wrong: str, tmp_path: Path) -> None:
    assert worker.weighed(_reading(read), tmp_path / "file")[2].startswith(wrong)


def test_memory_is_noticed(tmp_path: Path) -> None:
    assert worker.weighed(_reading(_hoard), tmp_path / "file")[0] > 2**26
    assert worker.weighed(_reading(_refuse), tmp_path / "file")[0] < 2**22


def test_a_reader_that_dies_or_hangs_is_noticed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The worker is exchanged for one that crashes at the second file and hangs at the fourth."""
    room = tmp_path / "fuzz"
    room.mkdir()
    (room / "__init__.py").touch()
    (room / "worker.py").write_text(
        "import os, sys, time\n"
        "for index in range(int(sys.argv[3]), int(sys.argv[3]) + int(sys.argv[4])):\n"
        "    print('READ', index, flush=True)\n"
        "    if index == 1: os.abort()\n"
        "    if index == 3: time.sleep(60)\n"
        "print('DONE', flush=True)\n"
    )
    monkeypatch.setattr("fuzz.runner._ROOM", tmp_path)
    monkeypatch.setattr("fuzz.runner.STALLED", 1.0)
    found = fuzz("gem", 6)
    assert list(found.wrong) == [1, 3]
    assert "died (-6)" in found.wrong[1]
    assert "no answer" in found.wrong[3]
    assert found.inputs == 6
