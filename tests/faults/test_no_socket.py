"""No command calls anybody or lets itself be called; tests/app/test_offline.py says the same of native libraries."""

from pathlib import Path

import pytest
from gemheads.app.cli import app

from .test_full_disk import commands, frames, run
from .test_killed_commands import played

__all__ = ["frames", "played"]

AUDIT = """
import sys

def heard(event, arguments):
    if event in ("socket.connect", "socket.bind", "socket.sendto", "socket.getaddrinfo", "socket.gethostbyname"):
        raise SystemExit(f"SOCKET {event} {arguments}")

sys.addaudithook(heard)
"""
ELSEWHERE = {
    "live": "listens only when told to: tests/app/desk/test_remote.py, tests/app/inputs/test_oscin.py",
    "track": "tests/app/test_offline.py",
    "verify": "tests/app/test_offline.py",
    "doctor": "with --live it tries its own ports on this machine",
    **dict.fromkeys(
        ("demo", "bench", "fit", "capture", "train", "refine", "evaluate"), "what these others do, in other orders"
    ),
}
"""Commands that are not looked at here, and why."""


@pytest.fixture(scope="module")
def words(tmp_path_factory: pytest.TempPathFactory, played: tuple[Path, Path], frames: Path) -> dict[str, list[str]]:
    """Name -> words of a small run of every command that needs no face."""
    out = tmp_path_factory.mktemp("out")
    return {**commands(played, frames, out), "info": ["info"], "info FILE": ["info", str(played[0])]}


def test_commands_open_no_socket(words: dict[str, list[str]]) -> None:
    quick = {name: given for name, given in words.items() if name != "train-regressor"}
    answers = run(0, quick, AUDIT)
    assert {name: answer.stderr for name, answer in answers.items() if answer.code} == {}


def test_a_training_opens_no_socket(words: dict[str, list[str]]) -> None:
    """One picture teaches nothing, and the avatar of these tests has no face: it ends early, but not by a socket."""
    answer = run(0, {"train-regressor": words["train-regressor"]}, AUDIT)["train-regressor"]
    assert "SOCKET" not in answer.stderr


def test_a_socket_would_be_noticed() -> None:
    torn = AUDIT + "import socket\nsocket.getaddrinfo('localhost', 80)\n"
    with pytest.raises(AssertionError, match=r"SOCKET socket\.getaddrinfo"):
        run(0, {}, torn)


def test_no_command_was_forgotten(words: dict[str, list[str]]) -> None:
    known = {*ELSEWHERE, *(name.split()[0] for name in words)}
    assert {name for name in app if not name.startswith("-")} <= known, "look whether the new ones open sockets"
