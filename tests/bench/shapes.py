"""How the tracker reads an avatar's single shapes, drawn from nothing to full, whether lids that fall turn its eyes,
whether eyes that look down still look aside, whether a mouth at rest seems to kiss where its head nods, and how far
its lips stand apart.

    python tests/bench/shapes.py [AVATAR.gem ...]

A shape that reads as nothing over half its way, and as all of itself soon after, cannot be steered: from the first
table models/heads/people.py has how faces rest, and how far their shapes go. In the second, eyes look straight ahead
and are half shut: the tracker reads both sides of a face alike, so that what seems to look aside is the face's. Then
they look down, and to the left by ASIDE as well: lids that hide the irises leave little of that. Seen from above, lips
that stand out are read as pursed: what such an avatar is taken for hangs on how its driver holds his head. A mouth that
looks closed and is read as open parts its lips from there, for all that is read of them.
"""

import argparse
from pathlib import Path

import numpy as np
from gemheads.models.crossing.channels import SCORE_CHANNELS, table
from gemheads.models.crossing.mirror import LOOKS, Mirror
from gemheads.models.crossing.reading import Reading, stacked
from gemheads.models.driver.features import BLOCKS
from gemheads.models.driver.measures import MEASURES
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of
from gemheads.render.arrays import Floats64, Image

ROOT = Path(__file__).resolve().parents[2]
SIZE = 384
SHAPES = ("jawOpen", "mouthSmile", "mouthPucker", "eyeBlink", "browInnerUp", "browDown")
WEIGHTS = (0.1, 0.15, 0.2, 0.25, 0.5, 0.75, 1.0)
HALF_SHUT = 0.5
FRONT = np.zeros(3)
ASIDE = 0.6
DOWN = {"eyeLookDown": 1.0}
NODS_DEG = (-15, 15, 25)
LIP_GAP = BLOCKS["measures"].start + MEASURES.index("lip_gap")
CHANNELS = [channel.name for channel in SCORE_CHANNELS]


def main() -> None:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("avatars", nargs="*", type=Path, default=sorted((ROOT / "assets" / "avatars").glob("*.gem")))
    mirrors = [Mirror(load_gem(path), SIZE) for path in parser.parse_args().avatars]
    print(
        f"| avatar | shape | {' | '.join(f'at {weight:g}' for weight in WEIGHTS)} |\n|---|---|{'---|' * len(WEIGHTS)}"
    )
    for mirror in mirrors:
        rest = seen(mirror, drawn(mirror))
        for shape in SHAPES:
            at = [channel(shape, seen(mirror, drawn(mirror, **{shape: weight})), rest) for weight in WEIGHTS]
            print(f"| {mirror.gem.name} | {shape} | {' | '.join(f'{one:.3f}' for one in at)} |")
    nods = f"at rest and nodding by {' '.join(f'{nod:+d}' for nod in NODS_DEG)} degrees, kisses by"
    print(f"\n| avatar | half shut, looks aside by | looking down, is read | and aside | {nods} | lips apart, mm |")
    print(f"|---|{'---|' * 5}")
    for mirror in mirrors:
        rest, half, down = (seen(mirror, drawn(mirror, **one)) for one in ({}, {"eyeBlink": HALF_SHUT}, DOWN))
        aside = seen(mirror, drawn(mirror, **DOWN, eyeLookOutLeft=ASIDE, eyeLookInRight=ASIDE))
        gaze = [("gaze horizontal", half), ("gaze vertical", down), ("gaze horizontal", aside)]
        cells = [f"{channel(name, reading, rest):+.2f}" for name, reading in gaze]
        nodding = [seen(mirror, drawn(mirror, np.radians([nod, 0.0, 0.0]))) for nod in NODS_DEG]
        cells.append(" ".join(f"{channel('mouthPucker', reading, rest):+.2f}" for reading in nodding))
        print(f"| {mirror.gem.name} | {' | '.join(cells)} | {10 * rest.features[LIP_GAP]:.1f} |")


def drawn(mirror: Mirror, turn: Floats64 = FRONT, **weights: float) -> Image:
    """The avatar's expression, its head turned [3]."""
    return mirror.draw(mirror.gem.arkit_coefficients(weights_of(**weights)), turn)


def seen(mirror: Mirror, picture: Image) -> Reading:
    """What a tracker that has settled on the picture reads."""
    mirror.restart()
    reading = mirror.read(picture, LOOKS)
    assert reading is not None, f"{mirror.gem.name} is not seen"
    return reading


def channel(name: str, reading: Reading, rest: Reading) -> float:
    """What one channel of the closed loop says of a picture."""
    return float(table(stacked([reading]), rest, portrait=True)[0, CHANNELS.index(name)])


if __name__ == "__main__":
    main()
