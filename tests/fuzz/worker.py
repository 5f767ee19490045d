"""Reads mutated files in a process of its own: ``python -m fuzz.worker FORMAT SEED FIRST COUNT``.

It tells each file before it is read, so that a crash or a hang can be told from outside, and then what was wrong.
"""

import os
import resource
import sys
import tempfile
import time
from pathlib import Path
from random import Random

from .formats import FORMATS, Format

MOST_SECONDS = 2.0
"""Of the processor; waiting for other programs does not count."""
ADDRESS_SPACE = 4 * 2**30
"""Beyond what the program has when it begins."""


def made(name: str, content: bytes, seed: int, index: int) -> bytes:
    """The mutation with this number, the same on every machine."""
    return FORMATS[name].mutated(content, Random(f"{name} {seed} {index}"))


def weighed(read: Format, path: Path) -> tuple[int, float, str]:
    """Bytes of memory that reading adds at its peak, seconds, and what is wrong."""
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before, started = _memory("VmRSS"), time.process_time()
    wrong = ""
    try:
        read.read(path)
    except read.error as error:
        if "\n" in str(error) or len(str(error)) > 2000:
            wrong = f"{len(str(error))} characters, or several lines, as a message"
    except Exception as error:
        wrong = f"{type(error).__name__}: {error}"[:300]
    return _memory("VmHWM") - before, time.process_time() - started, wrong


def _memory(field: str) -> int:
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(field):
            return int(line.split()[1]) * 1024
    return 0


def main(name: str, seed: int, first: int, count: int) -> None:
    """Read so many mutations from the ``first`` on."""
    fuzzed = FORMATS[name]
    told = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # decoders print what they like
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / fuzzed.name
        content = fuzzed.honest(Path(folder))
        path.write_bytes(content)
        fuzzed.read(path)  # what is loaded once does not count
        honest = max(weighed(fuzzed, path)[0], len(content))
        used = _memory("VmSize")
        resource.setrlimit(resource.RLIMIT_AS, (used + ADDRESS_SPACE, used + ADDRESS_SPACE))
        for index in range(first, first + count):
            print("READ", index, file=told, flush=True)
            path.write_bytes(made(name, content, seed, index))
            size = path.stat().st_size
            peak, seconds, wrong = weighed(fuzzed, path)
            if not wrong and seconds > MOST_SECONDS:
                wrong = f"{seconds:.1f} s of the processor"
            if not wrong and peak > 2 * max(honest, size) + fuzzed.memory:
                wrong = f"{peak / 2**20:.0f} MiB of memory"
            if wrong:
                print("WRONG", index, wrong.replace("\n", " "), file=told, flush=True)
    print("DONE", file=told, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], *(int(word) for word in sys.argv[2:]))
