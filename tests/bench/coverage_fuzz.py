"""Files bred for coverage by atheris: ``python tests/bench/coverage_fuzz.py gem,ply [--seconds 60] [--seed 7]``

The other half of the nightly fuzzing: ``fuzz.py`` mutates one honest file at random, this keeps what reached new lines
of the program and goes on from there. Every other mutation is that of the format, the rest are libFuzzer's. Needs
``pip install atheris``, which has wheels for Linux. Exits with 1 where a reader raised what it must not, hung or took
too much memory; the input is left in the current folder, as libFuzzer says.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

STALLED = 30
"""Seconds of the wall clock for one input."""
MEMORY = 4096
"""MiB in all."""
LARGEST = 2**20
"""Bytes of an input."""


def main() -> int:
    """Each format in a process of its own: libFuzzer ends the one that it runs in."""
    parser = argparse.ArgumentParser(description="Breed files for coverage.")
    parser.add_argument("formats", help="which formats, with commas between them, or all")
    parser.add_argument("--seconds", type=int, default=60, help="for each format")
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**31)
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.here:
        _breed(options.formats, options.seconds, options.seed)
        return 0
    from fuzz.formats import FORMATS

    failed = []
    for name in FORMATS if options.formats == "all" else options.formats.split(","):
        command = [sys.executable, __file__, name, "--here", f"--seconds={options.seconds}", f"--seed={options.seed}"]
        failed += [name] if subprocess.run(command).returncode else []
    print(f"wrong: {', '.join(failed)}" if failed else "nothing wrong")
    return int(bool(failed))


def _breed(name: str, seconds: int, seed: int) -> None:
    import atheris

    with atheris.instrument_imports(include=["gemheads"]):
        from fuzz.formats import FORMATS
    fuzzed = FORMATS[name]
    with tempfile.TemporaryDirectory() as folder:
        corpus = Path(folder) / "corpus"
        corpus.mkdir()
        path = Path(folder) / fuzzed.name
        content = fuzzed.honest(Path(folder))
        (corpus / "honest").write_bytes(content)
        path.write_bytes(content)
        fuzzed.read(path)

        def read(data: bytes) -> None:
            path.write_bytes(data)
            with suppress(fuzzed.error):
                fuzzed.read(path)

        def mutate(data: bytes, largest: int, chance: int) -> bytes:
            rng = Random(chance)
            if rng.random() < 0.5:
                return atheris.Mutate(data, largest)
            try:
                return fuzzed.mutated(data, rng)[:largest]
            except Exception:  # what is no such file any more has no parts to mutate
                return fuzzed.mutated(content, rng)[:largest]

        limits = [f"-max_total_time={seconds}", f"-timeout={STALLED}", f"-rss_limit_mb={MEMORY}", f"-seed={seed}"]
        arguments = [sys.argv[0], *limits, f"-max_len={LARGEST}", "-close_fd_mask=1", str(corpus)]
        atheris.Setup(arguments, read, custom_mutator=mutate)
        atheris.Fuzz()


if __name__ == "__main__":
    sys.exit(main())
