"""What commands say on a disk that may be full."""

import json
import subprocess
import sys
from typing import NamedTuple

from sealed import skip_where_refused

BYTES = 20_000
"""From here on the disk is full."""
PROGRAM = """
import contextlib, io, json, resource, signal, sys
from gemheads.app.cli import main

if int(sys.argv[1]):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]),) * 2)
answers = {}
for name, words in json.load(sys.stdin).items():
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        answers[name] = [main(words), said.getvalue()]
print(json.dumps(answers))
"""


class Answer(NamedTuple):
    """What a command said."""

    code: int
    stderr: str

    def error(self) -> str:
        """Its one line."""
        errors = [line for line in self.stderr.splitlines() if line.startswith("error: ")]
        assert self.code == 5, self.stderr
        assert len(errors) == 1, self.stderr
        assert "unexpected" not in errors[0]
        assert ";" in errors[0]  # what, and the cure
        return errors[0]


def run(limit: int, commands: dict[str, list[str]], first: str = "") -> dict[str, Answer]:
    """All of them in one process, which begins with ``first``; no file may grow beyond ``limit`` bytes."""
    program = [sys.executable, "-c", first + PROGRAM, str(limit)]
    given = json.dumps(commands)
    done = subprocess.run(program, input=given, capture_output=True, text=True, timeout=120, check=False)
    skip_where_refused(done)
    assert done.returncode == 0, done.stderr
    return {name: Answer(*answer) for name, answer in json.loads(done.stdout.splitlines()[-1]).items()}
