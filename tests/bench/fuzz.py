"""Mutated files by the hundred thousand: ``python tests/bench/fuzz.py [--inputs 100000] [--format gem,ply] [--seed 7]``

The nightly command. Exits with 1 when a reader crashed, hung, took too much memory or raised what it must not. The
number in the table, with the same format and seed, reads that input again: ``--first NUMBER --inputs 1``.
"""

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzz.formats import FORMATS
from fuzz.runner import fuzz
from rich.console import Console
from rich.table import Table


def main() -> int:
    """Fuzz the formats asked for and print what was found."""
    parser = argparse.ArgumentParser(description="Read mutated files.")
    parser.add_argument("--inputs", type=int, default=100_000, help="how many of each format")
    parser.add_argument("--format", default=",".join(FORMATS), help="which formats, with commas between them")
    parser.add_argument("--seed", type=int, default=time.time_ns() % 2**32, help="another one each time unless told")
    parser.add_argument("--first", type=int, default=0, help="the number of the first input")
    options = parser.parse_args()
    table = Table("format", "inputs", "a second", "wrong", "the first of them", box=None)
    failed = False
    print(f"seed {options.seed}", file=sys.stderr, flush=True)
    for name in options.format.split(","):
        found = fuzz(name, options.inputs, options.seed, options.first)
        failed |= bool(found.wrong)
        first = next((f"{index}: {what}" for index, what in found.wrong.items()), "")
        rate = found.inputs / max(1e-9, found.seconds)
        print(f"{name}: {found.inputs} read, {len(found.wrong)} wrong", file=sys.stderr, flush=True)
        table.add_row(name, f"{found.inputs}", f"{rate:.0f}", f"{len(found.wrong)}", first)
        for index, what in found.wrong.items():
            print(f"{name} {index}: {what}", file=sys.stderr, flush=True)
    Console().print(table)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
