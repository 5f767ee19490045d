"""The live loop for half an hour with faults at random: ``python tests/bench/soak.py [--minutes 30] [--seed 0]``.

Exits with 1 when a thread died, an output failed, memory or handles grew, or pictures came less evenly at the end.
"""

import argparse
import sys
import tempfile
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from soak.judging import complaints
from soak.loop import soak


def main() -> int:
    """Run, and print what was seen."""
    parser = argparse.ArgumentParser(description="Run the live loop in foul weather.")
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        soaked = soak(60 * options.minutes, Path(folder), options.seed, warm_up=min(30.0, 12 * options.minutes))
    worst = sorted(round(gap, 2) for gap in soaked.gaps)[-3:]
    print(f"{soaked.pictures} pictures, one every {1e3 * median(soaked.gaps):.1f} ms; longest waits {worst} s")
    stalls = sorted(round(stall, 2) for stall in soaked.stalls)[-3:]
    print(f"without those for a core {stalls} s")
    print(f"memory {soaked.rss[0]:.0f} to {soaked.rss[-1]:.0f} MB, at most {max(soaked.rss):.0f}")
    print(f"handles {soaked.handles[0]} to {soaked.handles[-1]}, threads {soaked.threads[0]} to {soaked.threads[-1]}")
    print(f"{soaked.engines_lost} engines died, {soaked.recordings} recordings, weather {soaked.weather}")
    told = complaints(soaked)
    print("\n".join(told) or "all promises kept")
    return bool(told)


if __name__ == "__main__":
    sys.exit(main())
