"""Seconds and decibels of `fit` on renders: a first frame, and frames that follow it.

    python tests/bench/fit_speed.py [--side 256] [--frames 6] [AVATAR.gem ...]

Without avatars, 15,000 splats on an ellipsoid with 50 components of noise a modality: for the seconds. The goals on two
cores: 1 s for the first frame, 0.3 s for one that follows. Processor seconds say what a busy machine hides.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from gemheads.app.bench.synthetic import synthetic_gem
from gemheads.app.performing.portrait import portrait
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.posing import pose_head
from gemheads.models.train.synthesis.fit import FIRST, NEXT, fit
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine

GREY = (0.75, 0.75, 0.75)


def performance(gem: Gem, frames: int, side: int) -> list[np.ndarray]:
    """Pictures of a head that turns while its expression changes: smooth random walks."""
    rng = np.random.default_rng(0)
    engine, camera = SoftwareEngine(), portrait(gem.viewing, side, side)
    ends = rng.normal(size=(2, gem.coefficient_count)) * gem.sigma * 0.7
    turns = rng.uniform(-0.15, 0.15, (2, 3))
    images = []
    for t in np.arange(frames) / 15:
        coefficients = gem.clamped(gem.rest_coefficients + (1 - t) * ends[0] + t * ends[1])
        turn = (1 - t) * turns[0] + t * turns[1]
        raw = pose_head(gem.compose(coefficients), gem.neck_weights, gem.neck_pivot, turn, np.zeros(3))
        images.append(over(engine.draw(raw, camera), GREY).copy())
    return images


def main() -> None:
    """Fit and print a row per avatar."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=256)
    parser.add_argument("--frames", type=int, default=6)
    parser.add_argument("avatars", nargs="*", type=Path)
    wish = parser.parse_args()
    gems = [load_gem(path) for path in wish.avatars] or [synthetic_gem(15_000, 50, np.random.default_rng(0))]
    for gem in gems:
        images, camera = performance(gem, wish.frames, wish.side), portrait(gem.viewing, wish.side, wish.side)
        fit(gem, images[:1], [camera], GREY, effort=NEXT)  # compiles
        rows, start = [], None
        for image in images:
            spent = time.process_time()
            found = fit(gem, [image], [camera], GREY, start, NEXT if start else FIRST)
            rows.append((found.seconds, time.process_time() - spent, found.psnr))
            start = found.start
        first, later = rows[0], np.array(rows[1:])
        print(
            f"{gem.name} {len(gem)} splats {wish.side}^2: first {first[0]:.2f} s ({first[1]:.2f} of processors)"
            f" {first[2]:.1f} dB; next least {later[:, 0].min():.2f} s, median {np.median(later[:, 0]):.2f}"
            f" ({np.median(later[:, 1]):.2f}), {later[:, 2].min():.1f} dB or more"
        )


if __name__ == "__main__":
    main()
