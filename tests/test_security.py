"""Every promise of SECURITY.md is kept by a test that is there."""

import ast
import re
import socket
from pathlib import Path

import pytest
from pytest_socket import SocketBlockedError

ROOT = Path(__file__).resolve().parents[1]
ROW = re.compile(r"^\| (?P<promise>[^|]+) \| (?P<tests>[^|]+) \|$", re.MULTILINE)
NAMED = re.compile(r"`(tests/[\w/]+\.py)::(test_\w+)`")


def promises() -> dict[str, list[tuple[str, str]]]:
    """Promise -> (file, function) of the tests that keep it."""
    text = (ROOT / "SECURITY.md").read_text("utf-8")
    rows = [row for row in ROW.finditer(text) if row["promise"] not in ("promise", "---")]
    return {row["promise"]: NAMED.findall(row["tests"]) for row in rows}


def test_there_are_promises() -> None:
    assert len(promises()) >= 25


@pytest.mark.parametrize(("promise", "tests"), promises().items())
def test_a_promise_is_kept_by_tests_that_are_there(promise: str, tests: list[tuple[str, str]]) -> None:
    assert tests, promise
    for file, name in tests:
        tree = ast.parse((ROOT / file).read_text("utf-8"))
        assert name in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}, f"{file}: {name}"


@pytest.mark.filterwarnings("ignore:A test tried to use socket")
def test_tests_run_without_a_network() -> None:
    with pytest.raises(SocketBlockedError):
        socket.socket()
