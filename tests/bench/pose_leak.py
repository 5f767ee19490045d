"""What a head that turns and does nothing else makes an avatar's expression do, by far and by near cameras.

    python tests/bench/pose_leak.py [AVATAR.gem ...] --heads HEAD.gem ... [--fov 20 42 64]

Each head keeps its expression and turns 20 degrees to either side. In each cell: the RMS of the coefficients that its
picture moves, in sigma, by the baseline and by the avatar's regressor; then in how far it turns 15 degrees up and down
and around, too. A head fills its picture from 1.1, 0.5 and 0.3 metres at fields of view of 20, 42 and 64 degrees.
"""

import argparse
from pathlib import Path

from gemheads.models.crossing.mirror import FOV_DEG, Mirror
from gemheads.models.crossing.poseleak import leak, turn
from gemheads.models.driver.answer import by_scores
from gemheads.models.driver.networks import FOLDER
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gemfile import load_gem


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    shipped = sorted((FOLDER.parent / "avatars").glob("*.gem"))
    parser.add_argument("avatars", nargs="*", type=Path, default=shipped, help="who follow; with ARKit shapes")
    parser.add_argument("--heads", nargs="+", type=Path, default=shipped, help="who turn")
    parser.add_argument("--fov", nargs="+", type=float, default=[FOV_DEG, 42.0, 64.0], help="degrees")
    parser.add_argument("--size", type=int, default=384, help="side of the pictures")
    asked = parser.parse_args()
    gems = {path: load_gem(path) for path in (*asked.avatars, *asked.heads)}
    print(
        f"| avatar | camera | {' | '.join(path.stem for path in asked.heads)} |\n|---|---|{'---|' * len(asked.heads)}"
    )
    for fov in asked.fov:
        turned = [turn(Mirror(gems[path], asked.size, fov)) for path in asked.heads]
        for path in asked.avatars:
            gem = gems[path]
            runs = by_scores(gem), Regressor.of(gem)
            leaks = [[leak(one, run, gem) for run in runs] for one in turned]
            cells = [
                ", ".join(" ".join(f"{getattr(one, where).sigma:.2f}" for one in both) for where in ("at_yaw", "all"))
                for both in leaks
            ]
            print(f"| {path.stem} | {fov:g} degrees | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
