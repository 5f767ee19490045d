"""Mutated files by the thousand, read in processes that may die."""

import os
import queue
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

STALLED = 30.0
"""Seconds of the wall clock without a word after which a reader hangs; short hangs the worker tells itself."""
BEGINS = 180.0
"""Seconds until its first word: it imports all that reads, on a machine that may be busy."""
_ROOM = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Found:
    """What fuzzing one format came to."""

    name: str
    inputs: int
    seconds: float
    wrong: dict[int, str]
    """Number of the input -> what is wrong. ``worker.made`` makes it again."""


def fuzz(name: str, inputs: int, seed: int = 0, first: int = 0, limit: float = float("inf")) -> Found:
    """Read mutations of one format, so many or for ``limit`` seconds; after a crash or a hang go on with the next."""
    started, wrong, index, last = time.monotonic(), {}, first, first + inputs
    while index < last and time.monotonic() - started < limit:
        index = _run(name, seed, index, last - index, wrong, started + limit)
    return Found(name, index - first, time.monotonic() - started, wrong)


def _run(name: str, seed: int, first: int, count: int, wrong: dict[int, str], until: float) -> int:
    """One process; returns the first number that it did not read."""
    command = [sys.executable, "-m", "fuzz.worker", name, str(seed), str(first), str(count)]
    places = os.pathsep.join(filter(None, (str(_ROOM), os.environ.get("PYTHONPATH", ""))))
    environment = {**os.environ, "PYTHONPATH": places, "OPENBLAS_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
    index = first - 1
    with tempfile.TemporaryFile("w+") as complaints:
        process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=complaints, text=True)
        lines: queue.Queue[str] = queue.Queue()
        reader = threading.Thread(target=_listen, args=(process, lines), daemon=True)
        reader.start()
        try:
            while line := lines.get(timeout=STALLED if index >= first else BEGINS):
                word, *rest = line.split(maxsplit=2)
                if word == "DONE":
                    return first + count
                index = int(rest[0])
                if word == "WRONG":
                    wrong[index] = rest[1].strip()
                if time.monotonic() > until:
                    return index + 1
            complaints.seek(0)
            told = complaints.read().strip().splitlines()[-1:]
            if index < first:
                raise RuntimeError(f"the reader of {name} did not begin: {told}")
            wrong[index] = f"the reader died ({process.wait()}): {told}"
        except queue.Empty:
            wrong[index] = f"no answer for {STALLED:g} s"
        finally:
            process.kill()
            process.wait()
            reader.join()
            if process.stdout is not None:
                process.stdout.close()
    return index + 1


def _listen(process: "subprocess.Popen[str]", lines: "queue.Queue[str]") -> None:
    if process.stdout is not None:
        for line in process.stdout:
            lines.put(line)
    lines.put("")
