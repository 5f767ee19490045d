"""Which rest, and how large shapes, make a face tracker read an avatar's mouth as WANTED says.

    python tests/bench/resting.py AVATAR.gem [--timid 0.5] [--steps 4]

A GEM is linear, so that a face at rest is tried without a bake, as ARKit weights that are added to all that the avatar
acts. Least squares find those, and factors on its shapes, from which the readings of WANTED follow best: of jaws and
kisses they are about what is read of Mara and Theo, of smiles and grins partly what is read of people. What they
print is what models/heads/people.py adds to a person's rest (divided by the factor where there is one: a rest is in
units of the person's own shapes), and the readings before and after. A bake that follows it reads alike, but not the
same: look at its pictures, run the tests of shipped avatars, and start here again from it.
"""

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from gemheads.models.crossing.mirror import LOOKS, Mirror
from gemheads.models.driver.features import BLOCKS, score
from gemheads.models.driver.measures import MEASURES
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of
from gemheads.render.arrays import Floats, Floats64
from scipy.optimize import least_squares

SIZE = 384
RESTS = (
    *("jawOpen", "mouthClose", "mouthSmile", "mouthFrown", "mouthStretch", "mouthDimple", "mouthPress", "mouthPucker"),
    *("mouthFunnel", "mouthRollUpper", "mouthRollLower", "mouthUpperUp", "mouthLowerDown"),
    *("mouthShrugUpper", "mouthShrugLower"),
)
"""Shapes of which a rest is made."""
GAINS = ("mouthUpperUp", "mouthLowerDown", "mouthSmile", "mouthPucker")
"""Shapes that may become larger or smaller."""
STEP = 0.04
"""Of one weight, to see what it does: readings tremble."""
FARTHEST = 0.4
UNIT = 0.15
"""Of a weight: as much counts for one, times how timid the search is."""
SURE = 1e-4
"""Scores beyond do not count."""

Weights = dict[str, float]


@dataclass(frozen=True)
class Wanted:
    """One reading of one picture, as it should be."""

    reads: str
    """A score, or one of MEASURES (cm, away from the rest)."""
    bound: Literal["is", "at most", "at least"]
    value: float
    weight: float = 1.0
    """Of one unit of log-odds, or of a centimetre."""

    def misses(self, reading: float) -> float:
        """By how much, signed, times the weight."""
        miss = reading - self.value if self.reads in MEASURES else _log_odds(reading) - _log_odds(self.value)
        reached = (self.bound == "at most" and miss < 0) or (self.bound == "at least" and miss > 0)
        return 0.0 if reached else self.weight * miss


@dataclass(frozen=True)
class Picture:
    """What an avatar acts, and by how many degrees its head nods."""

    acts: Weights
    nods: float
    wanted: tuple[Wanted, ...]


def _asked(acts: Weights, *wanted: Wanted, nods: float = 0.0) -> Picture:
    return Picture(acts, nods, wanted)


_NO_KISS = Wanted("mouthPucker", "at most", 0.04)
_NO_SMILE = Wanted("mouthSmileLeft", "at most", 0.04, 0.7)
_NO_JAW = Wanted("jawOpen", "at most", 0.02, 0.7)
_GRIN = {"mouthSmile": 0.8, "mouthUpperUp": 0.8, "mouthLowerDown": 1.0}
WANTED = (
    # of people's closed mouths a jaw of .000 to .020 is read; lower, and one that sinks behind closed lips is unheard
    _asked({}, Wanted("jawOpen", "is", 0.007), _NO_KISS, _NO_SMILE),
    *(_asked({}, _NO_KISS, _NO_SMILE, _NO_JAW, nods=nods) for nods in (-15.0, 8.0, 15.0, 25.0)),
    *(
        _asked({"jawOpen": acted}, Wanted("jawOpen", "is", read, 0.8), Wanted("lip_gap", "is", apart, 2.5), _NO_KISS)
        for acted, read, apart in (
            *((0.1, 0.015, 0.15), (0.15, 0.045, 0.35), (0.2, 0.13, 0.6)),
            *((0.25, 0.195, 0.75), (0.3, 0.245, 0.85), (0.5, 0.44, 1.45)),
        )
    ),
    _asked({"jawOpen": 0.2}, Wanted("mouthPucker", "at most", 0.1, 0.8), nods=15.0),
    *(
        _asked({"mouthPucker": acted}, Wanted("mouthPucker", "is", read, 0.6), _NO_JAW)
        for acted, read in ((0.1, 0.07), (0.25, 0.24), (0.5, 0.83))
    ),
    _asked({"mouthSmile": 0.2}, Wanted("mouthSmileLeft", "is", 0.15, 0.5)),
    _asked(
        {"mouthSmile": 0.5},
        *(Wanted("mouthSmileLeft", "is", 0.55, 0.5), Wanted("mouth_width", "is", 1.0, 2.0)),
    ),
    _asked(
        {"mouthSmile": 1.0},
        *(Wanted("mouth_width", "at least", 1.5, 4.0), Wanted("right_corner_height", "at most", 0.8, 4.0)),
    ),
    _asked(
        _GRIN,
        *(Wanted("mouthLowerDownLeft", "at least", 0.15), Wanted("mouthUpperUpLeft", "is", 0.75, 0.4)),
        *(Wanted("jawOpen", "at most", 0.09), Wanted("jaw_drop", "at most", 0.3, 6.0)),
    ),
    _asked(
        {"mouthUpperUp": 0.4, "mouthLowerDown": 0.3},
        *(Wanted("jawOpen", "at most", 0.05, 0.8), Wanted("lip_gap", "is", 0.7, 1.5), _NO_KISS),
    ),
)


def main() -> None:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("avatar", type=Path)
    parser.add_argument("--timid", type=float, default=0.5, help="how dearly weights are bought (default 0.5)")
    parser.add_argument("--steps", type=int, default=4, help="of the search, half a minute each (default 4)")
    options = parser.parse_args()
    mirror = Mirror(load_gem(options.avatar), SIZE)

    def misses(change: Floats64) -> Floats64:
        found = readings(mirror, *split(change))
        missed = [one.misses(value) for picture, got in found for one, value in zip(picture.wanted, got, strict=True)]
        return np.array([*missed, *(options.timid * change / UNIT)])

    def slopes(change: Floats64) -> Floats64:
        steps = STEP * np.eye(len(change))
        return np.stack([(misses(change + step) - misses(change - step)) / (2 * STEP) for step in steps], axis=1)

    start = np.zeros(len(RESTS) + len(GAINS))
    found = least_squares(misses, start, slopes, bounds=(-FARTHEST, FARTHEST), x_scale=UNIT, max_nfev=options.steps + 1)
    rest, gains = split(found.x)
    print("| acts | nods, degrees | wanted | before | after |\n|---|---|---|---|---|")
    for (picture, before), (_, after) in zip(readings(mirror, {}, {}), readings(mirror, rest, gains), strict=True):
        acts = ", ".join(f"{name} {weight:g}" for name, weight in picture.acts.items()) or "rest"
        for one, was, now in zip(picture.wanted, before, after, strict=True):
            print(f"| {acts} | {picture.nods:+g} | {one.reads} {one.bound} {one.value:g} | {was:.3f} | {now:.3f} |")
    print(f"\nMisses (sum of squares): {(misses(start) ** 2).sum():.1f} before, {2 * found.cost:.1f} after.")
    print("Added to the rest:", ", ".join(f"{name} {weight:+.3f}" for name, weight in rest.items()))
    print("Factors on shapes:", ", ".join(f"{name} {factor:.3f}" for name, factor in gains.items()))


def split(change: Floats64) -> tuple[Weights, Weights]:
    """What is added to the rest, and factors on shapes."""
    gains = 1 + change[len(RESTS) :]
    return dict(zip(RESTS, change.tolist(), strict=False)), dict(zip(GAINS, gains.tolist(), strict=True))


def readings(mirror: Mirror, rest: Weights, gains: Weights) -> list[tuple[Picture, list[float]]]:
    """What is read of each picture of WANTED, in the order of what is wanted."""
    resting = look(mirror, rest, {}, 0.0)
    found = []
    for picture in WANTED:
        acts = {name: gains.get(name, 1.0) * weight for name, weight in picture.acts.items()}
        seen = look(mirror, rest, acts, picture.nods)
        found.append((picture, [value_of(one.reads, seen, resting) for one in picture.wanted]))
    return found


def look(mirror: Mirror, rest: Weights, acts: Weights, nods: float) -> Floats:
    """Features [D] of an avatar that rests so and acts that, read as a picture of its own."""
    weights = weights_of(**rest) + weights_of(**acts)
    mirror.restart()
    picture = mirror.draw(mirror.gem.arkit_coefficients(weights), np.radians([nods, 0.0, 0.0]))
    reading = mirror.read(picture, LOOKS)
    assert reading is not None, f"{mirror.gem.name} is not seen"
    return reading.features


def value_of(reads: str, seen: Floats, resting: Floats) -> float:
    """A score, or by how much a measure differs from the rest's."""
    if reads not in MEASURES:
        return float(score(seen, reads))
    place = BLOCKS["measures"].start + MEASURES.index(reads)
    return float(seen[place] - resting[place])


def _log_odds(probability: float) -> float:
    sure = np.clip(probability, SURE, 1 - SURE)
    return float(np.log(sure / (1 - sure)))


if __name__ == "__main__":
    main()
