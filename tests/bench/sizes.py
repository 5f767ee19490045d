"""How far open a jaw is read in pictures of several sizes: of people, and of avatars that follow them.

    python tests/bench/sizes.py [CLIP ...] [--avatars AVATAR.gem ...]

People are read alike however large their pictures are. Splats spread by about half a pixel more than they are large
(``DILATION`` in render/projection.py, as everywhere 3D Gaussians are drawn), and half a pixel is more of a face in a
small picture: lips that hardly part are drawn closed. The last row of an avatar is drawn large and read small. So an
avatar is taught with pictures of the size in which it is judged (``PICTURE_SIZE`` in
models/train/regressors/response.py).
"""

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from gemheads.app.evaluation.drivers import Driver, opened_drivers
from gemheads.models.crossing.clip import Clip, track_clip
from gemheads.models.crossing.kept import Kept
from gemheads.models.crossing.loop import echo
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.crossing.reading import Reading, Readings
from gemheads.models.driver.features import score
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.render.arrays import Floats, Image

ROOT = Path(__file__).resolve().parents[2]
DRIVERS = ROOT.parent / "shared" / "data" / "drivers"
EVERY, SECONDS = 8, 24.0
SIZES = (256, 320, 384, 512, 720)
SEEN_AT = 384
SCALES = (0.5, 1.0, 2.0)
"""Of people's own pictures."""
AJAR = (0.05, 0.15)
"""Range of a person's jaw score in which it is a little open."""


class Shrunk(Mirror):
    """Draws a picture larger than the tracker gets to see it."""

    def read(self, picture: Image, looks: int = 1) -> Reading | None:
        """What the tracker reads off a picture of SEEN_AT pixels."""
        return super().read(cv2.resize(picture, (SEEN_AT, SEEN_AT), interpolation=cv2.INTER_AREA), looks)


def main() -> None:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clips", nargs="*", type=Path, default=sorted(DRIVERS.glob("*.mp4")))
    parser.add_argument("--avatars", nargs="+", type=Path, default=sorted((ROOT / "assets" / "avatars").glob("*.gem")))
    parser.add_argument("--cache", type=Path, default=Path(tempfile.gettempdir()) / "gemheads-closed-loop")
    asked = parser.parse_args()
    if not asked.clips:
        parser.error("no clips: name videos of faces")
    kept = Kept(asked.cache)
    drivers = opened_drivers([str(path) for path in asked.clips])
    clips = [driver.tracked(EVERY, SECONDS, kept).clip for driver in drivers]
    print("| who, pixels | jaw where people's is a little open | correlation, median of clips |\n|---|---|---|")
    jaws = [opened(clip.readings, clip.neutral) for clip in clips]
    print(f"| people | {row(jaws, jaws)} |")
    for scale in SCALES:
        scaled = [track_clip(resized(driver, scale), EVERY, SECONDS) for driver in drivers]
        # a face that is lost in one size would shift all that follow
        pairs = [(jaw, one) for jaw, one in zip(jaws, scaled, strict=True) if len(one.readings) == len(jaw)]
        shown = [opened(one.readings, one.neutral) for _, one in pairs]
        print(f"| people, pictures x{scale:g} | {row([jaw for jaw, _ in pairs], shown)} |", flush=True)
    for gem in (load_gem(path) for path in asked.avatars):
        mirrors = {f"{size}": Mirror(gem, size) for size in SIZES}
        mirrors |= {f"{SIZES[-1]}, seen at {SEEN_AT}": Shrunk(gem, SIZES[-1])}
        for name, mirror in mirrors.items():
            print(f"| {gem.name}, {name} | {row(*followed(clips, gem, mirror))} |", flush=True)


def resized(driver: Driver, scale: float) -> Iterator[tuple[Image, float]]:
    """A driver's pictures in another size, with their times."""
    for picture, now in driver.frames():
        yield cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), now


def followed(clips: list[Clip], gem: Gem, mirror: Mirror) -> tuple[list[Floats], list[Floats]]:
    """Jaws of each clip's person and of the avatar that follows, in the frames in which it is seen."""
    people: list[Floats] = []
    avatars: list[Floats] = []
    for clip in clips:
        shown = echo(clip, Regressor.of(gem), mirror)
        people.append(opened(clip.readings, clip.neutral)[shown.seen])
        avatars.append(opened(shown.readings, shown.neutral))
    return people, avatars


def opened(readings: Readings, neutral: Reading) -> Floats:
    """[F] scores of the jaw, relative to the neutral's."""
    return np.array([score(one, "jawOpen") for one in readings.features - neutral.features])


def row(people: list[Floats], shown: list[Floats]) -> str:
    """Cells: the mean of ``shown`` where people's jaws are a little open, and how the two move together."""
    person, other = np.concatenate(people), np.concatenate(shown)
    ajar = (person > AJAR[0]) & (person < AJAR[1])
    mean = f"{other[ajar].mean():.3f}" if ajar.any() else "-"
    return f"{mean} | {np.median([np.corrcoef(a, b)[0, 1] for a, b in zip(people, shown, strict=True)]):.3f}"


if __name__ == "__main__":
    main()
