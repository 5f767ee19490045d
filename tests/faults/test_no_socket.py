"""No command calls anybody or lets itself be called; tests/app/test_offline.py says the same of native libraries."""

from pathlib import Path

import pytest
from answers import run
from gemheads.app.cli import app
from gemheads.app.inputs.oscin import PORTS

from .runs import commands

AUDIT = """
import sys

allowed = ()

def heard(event, arguments):
    if event in ("socket.connect", "socket.bind", "socket.sendto", "socket.getaddrinfo", "socket.gethostbyname"):
        if arguments[-1] not in allowed:
            raise SystemExit(f"SOCKET {event} {arguments}")

sys.addaudithook(heard)
"""
ELSEWHERE = {
    "live": "tests/app/desk/test_window.py; it listens only when told to: tests/app/desk/test_remote.py",
    **dict.fromkeys(("track", "verify"), "tests/app/test_offline.py"),
    **dict.fromkeys(("capture", "train", "refine", "fit", "evaluate"), "tests/faults/test_learning.py"),
    "demo": "reenact, of a clip that is shipped",
}
"""Commands that are looked at elsewhere."""


@pytest.fixture(scope="module")
def words(tmp_path_factory: pytest.TempPathFactory, played: tuple[Path, Path], frames: Path) -> dict[str, list[str]]:
    """Name -> words of a small run of every command that needs no face."""
    out = tmp_path_factory.mktemp("out")
    return {
        **commands(played, frames, out),
        **{"info": ["info"], "info FILE": ["info", str(played[0])], "bench": ["bench", "--quick"]},
    }


def test_commands_open_no_socket(words: dict[str, list[str]]) -> None:
    quick = {name: given for name, given in words.items() if name != "train-regressor"}
    answers = run(0, quick, AUDIT)
    assert {name: answer.stderr for name, answer in answers.items() if answer.code} == {}


def test_a_training_opens_no_socket(words: dict[str, list[str]]) -> None:
    """One picture teaches nothing, and the avatar of these tests has no face: it ends early, but not by a socket."""
    answer = run(0, {"train-regressor": words["train-regressor"]}, AUDIT)["train-regressor"]
    assert "SOCKET" not in answer.stderr


def test_doctor_tries_ports_of_this_computer_alone() -> None:
    """Those on which face data comes in."""
    ports = [("127.0.0.1", port) for port in PORTS.values()]
    run(0, {"doctor": ["doctor"]}, AUDIT.replace("allowed = ()", f"allowed = {ports}"))


def test_a_socket_would_be_noticed() -> None:
    torn = AUDIT + "import socket\nsocket.getaddrinfo('localhost', 80)\n"
    with pytest.raises(AssertionError, match=r"SOCKET socket\.getaddrinfo"):
        run(0, {}, torn)


def test_no_command_was_forgotten(words: dict[str, list[str]]) -> None:
    known = {"doctor", *ELSEWHERE, *(name.split()[0] for name in words)}
    assert {name for name in app if not name.startswith("-")} <= known, "look whether the new ones open sockets"
