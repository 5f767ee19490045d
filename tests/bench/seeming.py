"""How well the tracker reads the turn of a head whose face acts, with and without what the face only seems to turn.

    python tests/bench/seeming.py [AVATAR.gem ...] [--strangers OTHER.gem ...]

Avatars act random faces with heads turned by known angles. In each cell: the RMS error of the turn in degrees, pitch,
yaw and roll; of the face taken as rigid, with what was learned from the other avatars alone, and with what ships.
"""

import argparse
from pathlib import Path

import numpy as np
from gemheads.models.driver.networks import FOLDER, SEEMING_FILE, read_checked
from gemheads.models.driver.seeming import Seeming, read_seeming
from gemheads.models.gemfile import load_gem
from gemheads.models.train.seeming import AVATARS, Sitting, learned, sit


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("avatars", nargs="*", type=Path, default=sorted(AVATARS.glob("*.gem")))
    parser.add_argument("--strangers", nargs="*", type=Path, default=[], help="avatars that nothing is learned from")
    parser.add_argument("--pictures", type=int, default=1500, help="of each avatar (%(default)s)")
    asked = parser.parse_args()
    sittings = {path.stem: sit(load_gem(path), asked.pictures, 1) for path in (*asked.avatars, *asked.strangers)}
    known = [path.stem for path in asked.avatars]
    shipped = read_seeming(read_checked(FOLDER, SEEMING_FILE))
    print("| avatar | rigid | learned from the others | what ships |\n|---|---|---|---|")
    for name, sitting in sittings.items():
        others = learned([sittings[other] for other in known if other != name])
        cells = (cell(sitting.errors), cell(left(sitting, others)), cell(left(sitting, shipped)))
        print(f"| {name} | {' | '.join(cells)} |")


def left(sitting: Sitting, seeming: Seeming) -> np.ndarray:
    """[P, 3] errors that are left."""
    return sitting.errors - [seeming.turn(seeming.mean + one) for one in sitting.moved]


def cell(errors: np.ndarray) -> str:
    return " ".join(f"{degrees:.2f}" for degrees in np.degrees(errors.std(0)))


if __name__ == "__main__":
    main()
