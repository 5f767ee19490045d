"""How much of what the tracker reads on an avatar is chance: clips drive it, and it is read in pictures of two sizes.

    python tests/bench/reread.py AVATAR.gem [CLIP ...]

For each channel the median over clips of the correlation between the two readings, beside that of the avatar with its
driver. What a model of the avatar's response could still learn is what lies between.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np
from gemheads.app.evaluation.drivers import opened_drivers
from gemheads.models.crossing.channels import SCORE_CHANNELS, correlations, table
from gemheads.models.crossing.clip import Clip
from gemheads.models.crossing.kept import Kept
from gemheads.models.crossing.loop import Echo, echo
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gemfile import load_gem
from numpy.typing import NDArray

DRIVERS = Path(__file__).resolve().parents[3] / "shared" / "data" / "drivers"
SIZES = 384, 352
"""Sides of the pictures."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("avatar", type=Path)
    parser.add_argument("clips", nargs="*", type=Path, help=f"videos of faces (default: those of {DRIVERS.name}/)")
    parser.add_argument("--components", type=int, default=30)
    parser.add_argument("--every", type=int, default=4, help="take each N-th frame")
    parser.add_argument("--seconds", type=float, default=24.0, help="of each clip")
    asked = parser.parse_args()
    clips = asked.clips or sorted(DRIVERS.glob("*.mp4"))
    if not clips:
        parser.error("no clips: name videos of faces")
    gem = load_gem(asked.avatar)
    regressor = Regressor.of(gem)
    mirrors = [Mirror(gem, size) for size in SIZES]
    kept = Kept(Path(tempfile.gettempdir()) / "gemheads-closed-loop")
    followed, again = [], []
    for driver in opened_drivers([str(path) for path in clips]):
        clip = driver.tracked(asked.every, asked.seconds, kept).clip
        first, second = (echo(clip, regressor, mirror, asked.components) for mirror in mirrors)
        wanted, *read = tables(clip, first, second)
        followed.append(correlations(wanted, read[0]))
        both = correlations(read[0], read[1])
        again.append(np.where(np.isnan(followed[-1]), np.nan, both))
    print("| channel | avatar and driver | the avatar in two sizes |\n|---|---|---|")
    for place, channel in enumerate(SCORE_CHANNELS):
        cells = (median([clip[place] for clip in figures]) for figures in (followed, again))
        print(f"| {channel.name} | {' | '.join(cells)} |")


def median(figures: list[float]) -> str:
    """Of the clips in which somebody does it at all."""
    known = [figure for figure in figures if not np.isnan(figure)]
    return f"{np.median(known):.3f}" if known else "-"


def tables(clip: Clip, first: Echo, second: Echo) -> list[NDArray[np.float64]]:
    """[S, channels] of driver, avatar and avatar, in the S frames in which both pictures of the avatar were read."""
    both = first.seen & second.seen
    answer = [table(clip.readings.only(both), clip.neutral)]
    return answer + [table(one.readings.only(both[one.seen]), one.neutral, portrait=True) for one in (first, second)]


if __name__ == "__main__":
    main()
