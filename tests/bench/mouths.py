"""How people smile, grin and begin to open their mouths, how avatars do, and what is left of a whole expression.

    python tests/bench/mouths.py [CLIP ...] [--avatars AVATAR.gem ...]

models/heads/units.py has what a smile is made of from the first two tables. The third is of the frames in which people
bare their teeth, and of the avatars that follow these; the fourth, of those in which the jaw is a little open and lips
hardly part. In the fifth nobody does anything: where the score of the jaw is next to nothing at rest, it wakes late. In
the sixth jaws of avatars drop behind lips that stay closed. models/train/regressors/controls.py has where coefficients
begin to bend from the next. The last asks an avatar's regressor for the avatar's own expressions: what it does not give
back there, no driver gets.
"""

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from gemheads.app.evaluation.drivers import opened_drivers
from gemheads.models.crossing.clip import Clip
from gemheads.models.crossing.kept import Kept
from gemheads.models.crossing.loop import answered
from gemheads.models.crossing.mirror import LOOKS, Mirror
from gemheads.models.crossing.reading import Reading
from gemheads.models.driver.features import BLOCKS, SCORE_NAMES, score
from gemheads.models.driver.measures import MEASURES
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of
from gemheads.models.train.regressors.controls import STRAIGHT, controls_of
from gemheads.render.arrays import Floats, Image
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[2]
DRIVERS = ROOT.parent / "shared" / "data" / "drivers"
EVERY, SECONDS, SIZE = 4, 24.0, 384
SCORES = ((0.15, 0.35), (0.35, 0.55), (0.55, 0.75), (0.75, 1.0))
"""Ranges of the smile's score in which people are put together."""
BARED = 0.45
"""The score of a raised upper lip from which a smile with teeth is a grin, ..."""
SMILING = 0.5
"""... that of the smile itself ..."""
SHUT = 0.12
"""... and that of the jaw up to which it is: farther open it is a laugh."""
AJAR = (0.03, 0.08)
"""Range of the jaw's score in which it is a little open, ..."""
CLOSED_CM = 0.3
"""... and the distance of the lips up to which they hardly part."""
GRIN = ("mouthSmile", "mouthUpperUp", "mouthLowerDown", "jawOpen")
PARTING = ("jawOpen", "mouthClose")
DROPPED = (0.1, 0.2, 0.3, 0.5)
"""Weights of a jaw ..."""
BEHIND = 0.7
"""... of which the lips take back so much."""
LIP_GAP, JAW_DROP = (BLOCKS["measures"].start + MEASURES.index(name) for name in ("lip_gap", "jaw_drop"))
WHOLE = ("mouthSmile", "mouthUpperUp", "jawOpen", "mouthPucker", "browInnerUp")
TEETH = {"mouthSmile": 1.0, "mouthUpperUp": 0.5, "cheekSquint": 0.5, "eyeSquint": 0.2}


def main() -> None:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clips", nargs="*", type=Path, default=sorted(DRIVERS.glob("*.mp4")))
    parser.add_argument("--avatars", nargs="+", type=Path, default=sorted((ROOT / "assets" / "avatars").glob("*.gem")))
    parser.add_argument("--cache", type=Path, default=Path(tempfile.gettempdir()) / "gemheads-closed-loop")
    asked = parser.parse_args()
    if not asked.clips:
        parser.error("no clips: name videos of faces")
    gems = [load_gem(path) for path in asked.avatars]
    mirrors = [Mirror(gem, SIZE) for gem in gems]
    print("| people, by score | frames | smile | mouth wider, cm | corners higher, cm |\n|---|---|---|---|---|")
    kept = Kept(asked.cache)
    drivers = opened_drivers([str(path) for path in asked.clips])
    clips = [driver.tracked(EVERY, SECONDS, kept).clip for driver in drivers]
    people(clips)
    print("\n| avatar, weight of the smile | smile | mouth wider, cm | corners higher, cm |\n|---|---|---|---|")
    for mirror in mirrors:
        for smile in (0.5, 1.0):
            features = shown(mirror, mouthSmile=smile)
            print(f"| {mirror.gem.name} {smile} | {smile_of(features)} |")
    moments("grins", clips, mirrors, GRIN, grinning)
    moments("small jaws", clips, mirrors, PARTING, ajar)
    print("\n| at rest | jawOpen | lips apart, mm |\n|---|---|---|")
    rests = [(driver.name, clip.neutral) for driver, clip in zip(drivers, clips, strict=True)]
    for name, rest in rests + [(mirror.gem.name, mirror.neutral()) for mirror in mirrors]:
        print(f"| {name} | {score(rest.features, 'jawOpen'):.4f} | {10 * rest.features[LIP_GAP]:.1f} |")
    print(f"\n| jaw behind lips: read, mm apart | {' | '.join(f'{weight:g}' for weight in DROPPED)} |")
    print(f"|---|{'---|' * len(DROPPED)}")
    for mirror in mirrors:
        print(f"| {mirror.gem.name} | {' | '.join(behind_lips(mirror, weight) for weight in DROPPED)} |")
    print(f"\n| left of a whole | {' | '.join(WHOLE)} |\n|---|{'---|' * len(WHOLE)}")
    for gem in gems:
        for name, straight in (("equation 4", 0.0), (f"bent from {3 * STRAIGHT:.1f} sigma", STRAIGHT)):
            print(f"| {gem.name}, {name} | {' | '.join(f'{left(gem, shape, straight):.2f}' for shape in WHOLE)} |")
    print("\n| asked for its own | smile given back | with teeth | brows lowered with it |\n|---|---|---|---|")
    for mirror in mirrors:
        cells = ["-"] * 3  # nobody teaches it what to answer
        if mirror.gem.regressor is not None:
            plain, teeth = given_back(mirror, mouthSmile=1.0), given_back(mirror, **TEETH)
            cells = [f"{one:.2f}" for one in (plain["mouthSmile"], teeth["mouthSmile"], teeth["browDown"])]
        print(f"| {mirror.gem.name} | {' | '.join(cells)} |")


def people(clips: list[Clip]) -> None:
    """Rows of the mean of all frames in which somebody smiles so much, relative to the driver's neutral."""
    features = np.concatenate([clip.readings.features - clip.neutral.features for clip in clips])
    smiles = both(features, "mouthSmile")
    for low, high in SCORES:
        chosen = (smiles > low) & (smiles <= high)
        if chosen.any():
            print(f"| {low} to {high} | {chosen.sum()} | {smile_of(features[chosen].mean(0))} |")


def moments(
    name: str, clips: list[Clip], mirrors: list[Mirror], scores: tuple[str, ...], chosen: Callable[[Floats], Floats]
) -> None:
    """A table: means of the frames of clips of whose relative features [F, D] ``chosen`` says so, and of the avatars
    that repeat each of these."""
    print(f"\n| {name} of | frames | {' | '.join(scores)} | lips apart, cm | jaw drop, cm |")
    print(f"|---|{'---|' * (len(scores) + 3)}")
    frames: list[tuple[Clip, Reading]] = []
    for clip in clips:
        places = np.flatnonzero(chosen(clip.readings.features - clip.neutral.features))
        frames += [(clip, clip.readings[int(place)]) for place in places]
    if not frames:
        return
    print(f"| people | {_mean([reading.features - clip.neutral.features for clip, reading in frames], scores)} |")
    for mirror in mirrors:
        if mirror.gem.regressor is None:
            continue
        regressor = Regressor.of(mirror.gem)
        repeated = [answered(regressor, reading, clip.neutral) for clip, reading in frames]
        still = mirror.neutral()
        shown_of = [_look(mirror, mirror.follow(answer)) for answer in repeated]
        print(f"| {mirror.gem.name} | {_mean([one.features - still.features for one in shown_of], scores)} |")


def grinning(features: Floats) -> Floats:
    """[F] whether somebody grins, of relative features [F, D]."""
    teeth = (both(features, "mouthUpperUp") > BARED) & (both(features, "jawOpen") < SHUT)
    return teeth & (both(features, "mouthSmile") > SMILING)


def ajar(features: Floats) -> Floats:
    """[F] whether somebody's jaw is a little open behind lips that hardly part, of relative features [F, D]."""
    jaw = both(features, "jawOpen")
    return (jaw > AJAR[0]) & (jaw < AJAR[1]) & (features[:, LIP_GAP] < CLOSED_CM)


def _mean(features: list[NDArray[np.float32]], names: tuple[str, ...]) -> str:
    """Cells: how many, the means of scores, of the lips' distance and of the chin's from the nose, of relative
    features, each [D]."""
    mean = np.mean(features, 0)
    scores = " | ".join(f"{float(both(mean, name)):.3f}" for name in names)
    return f"{len(features)} | {scores} | {mean[LIP_GAP]:.2f} | {mean[JAW_DROP]:.2f}"


def behind_lips(mirror: Mirror, weight: float) -> str:
    """A cell: how far open a jaw is read, and by how many millimetres the lips part, which shall stay closed."""
    features = shown(mirror, jawOpen=weight, mouthClose=BEHIND * weight)
    return f"{both(features, 'jawOpen'):.3f}, {10 * features[LIP_GAP]:.1f}"


def both(features: Floats, name: str) -> Floats:
    """A score, or the mean of both sides, of relative features [..., D]."""
    if name in SCORE_NAMES:
        return score(features, name)
    return (score(features, f"{name}Left") + score(features, f"{name}Right")) / 2


def smile_of(features: Floats) -> str:
    """Cells: score, how much wider the mouth is, how much higher its corners, of relative features [D]."""
    smile = both(features, "mouthSmile")
    measures = dict(zip(MEASURES, features[BLOCKS["measures"]], strict=True))
    height = (measures["left_corner_height"] + measures["right_corner_height"]) / 2
    return f"{smile:.2f} | {measures['mouth_width']:.2f} | {height:.2f}"


def shown(mirror: Mirror, **weights: float) -> Floats:
    """Relative features [D] of an avatar's expression."""
    picture = mirror.draw(mirror.gem.arkit_coefficients(weights_of(**weights)), np.zeros(3))
    return _look(mirror, picture).features - mirror.neutral().features


def _look(mirror: Mirror, picture: Image) -> Reading:
    mirror.restart()
    reading = mirror.read(picture, LOOKS)
    assert reading is not None, f"{mirror.gem.name} is not seen"
    return reading


def left(gem: Gem, shape: str, straight: float) -> float:
    """Share of a whole expression that is left where coefficients bend from ``straight`` of 3 sigma on."""
    controls = replace(controls_of(gem), straight=straight)
    weights = weights_of(**{shape: 1.0}).astype(np.float32)
    asked = weights @ controls.to_coefficients / controls.limit
    made = (controls.coefficients(weights) - controls.rest) / controls.limit
    return float(made @ asked / (asked @ asked))


def given_back(mirror: Mirror, **weights: float) -> dict[str, float]:
    """Weights of an expression's shapes, and of lowered brows, that the regressor answers to a picture of it."""
    coefficients = Regressor.of(mirror.gem)(shown(mirror, **weights), np.zeros(3)).coefficients
    answer = controls_of(mirror.gem).weights(coefficients[None])[0]
    return {shape: float(answer[weights_of(**{shape: 1.0}) > 0].mean()) for shape in (*weights, "browDown")}


if __name__ == "__main__":
    main()
