"""Distillation at full size: seconds and peak memory (goal: 1,000 frames of 60,000 splats in 60 s and 4 GiB).

    python tests/bench/distill.py [--frames 1000] [--splats 60000] [--components 50]

Writes about 44 bytes a splat and frame to the temporary folder: 2.6 GB at full size.
"""

import argparse
import resource
import time
from collections.abc import Iterator

import numpy as np
from gemheads.models.distill import Distilled, distill
from gemheads.models.gem import MODALITIES
from gemheads.render.gaussians import RawGaussians

CONTROLS = 60
"""Hidden movements; each frame is moved by three of them, so that making frames takes little time."""


class Performance:
    """Frames of a head that moves in a low rank, and the seconds spent on making them."""

    def __init__(self, frames: int, splats: int) -> None:
        rng = np.random.default_rng(0)
        self.frames, self.splats, self.seconds = frames, splats, 0.0
        self._mean = rng.normal(0, 0.1, (splats, 11)).astype(np.float32)
        self._moves = rng.normal(0, 0.005, (CONTROLS, splats, 11)).astype(np.float32)
        self._colors = np.full((splats, 3), 0.5, np.float32)
        self._rng = rng

    def __iter__(self) -> Iterator[RawGaussians]:
        for _ in range(self.frames):
            start = time.perf_counter()
            values = self._mean.copy()
            for control in self._rng.choice(CONTROLS, 3, replace=False):
                values += np.float32(self._rng.normal() * 40 / (4 + control)) * self._moves[control]
            frame = RawGaussians(values[:, :3], values[:, 3:7], values[:, 7:10], values[:, 10], self._colors)
            self.seconds += time.perf_counter() - start
            yield frame


def measure(frames: int, splats: int, components: int) -> tuple[Distilled, float]:
    """What came out, and the seconds without the making of the frames."""
    performance = Performance(frames, splats)
    start = time.perf_counter()
    answer = distill(performance, components)
    return answer, time.perf_counter() - start - performance.seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--splats", type=int, default=60_000)
    parser.add_argument("--components", type=int, default=50)
    options = parser.parse_args()
    answer, seconds = measure(options.frames, options.splats, options.components)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"{options.frames} frames of {options.splats} splats: {seconds:.1f} s, peak {peak:.2f} GiB")
    for name in MODALITIES:
        kept = answer.variance_kept[name]
        print(f"  {name:8} {len(answer.bases[name])} components keep {kept[-1] if len(kept) else 1:.4%}")


if __name__ == "__main__":
    main()
