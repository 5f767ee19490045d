"""How a command refuses: an exit code, and one line that says what failed."""

import pytest
from gemheads.app.cli import main


def refusal(stderr: str) -> str:
    """The one line, beside which nothing is said: no traceback, no warning."""
    assert stderr.startswith("error: "), stderr
    assert stderr.count("\n") == 1, stderr
    assert stderr.endswith("\n"), stderr
    return stderr


def refused(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str]:
    """Exit code and the one line of ``gemheads`` with these words."""
    code = main([str(word) for word in words])
    return code, refusal(capsys.readouterr().err)
