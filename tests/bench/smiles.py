"""How people smile, how avatars do, how they grin, and how much of a whole expression a driven avatar shows.

    python tests/bench/smiles.py [CLIP ...] [--avatars AVATAR.gem ...]

models/heads/units.py has what a smile is made of from the first two tables. The third is of the frames in which people
bare their teeth, and of the avatars that follow these. models/train/regressors/controls.py has where coefficients begin
to bend from the fourth. The last asks an avatar's regressor for the avatar's own expressions: what it does not give
back there, no driver gets.
"""

import argparse
import tempfile
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
GRIN = ("mouthSmile", "mouthUpperUp", "mouthLowerDown", "jawOpen")
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
    clips = [driver.tracked(EVERY, SECONDS, kept).clip for driver in opened_drivers([str(p) for p in asked.clips])]
    people(clips)
    print("\n| avatar, weight of the smile | smile | mouth wider, cm | corners higher, cm |\n|---|---|---|---|")
    for mirror in mirrors:
        for smile in (0.5, 1.0):
            features = shown(mirror, mouthSmile=smile)
            print(f"| {mirror.gem.name} {smile} | {smile_of(features)} |")
    print(f"\n| grins of | frames | {' | '.join(GRIN)} | lips apart, cm |\n|---|---|{'---|' * len(GRIN)}---|")
    grins(clips, mirrors)
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


def grins(clips: list[Clip], mirrors: list[Mirror]) -> None:
    """Rows of the mean of all frames in which somebody grins, and of the avatars that repeat each of these."""
    moments: list[tuple[Clip, Reading]] = []
    for clip in clips:
        features = clip.readings.features - clip.neutral.features
        teeth = (both(features, "mouthUpperUp") > BARED) & (both(features, "jawOpen") < SHUT)
        chosen = np.flatnonzero(teeth & (both(features, "mouthSmile") > SMILING))
        moments += [(clip, clip.readings[int(place)]) for place in chosen]
    if not moments:
        return
    print(f"| people | {grin_of([reading.features - clip.neutral.features for clip, reading in moments])} |")
    for mirror in mirrors:
        if mirror.gem.regressor is None:
            continue
        regressor = Regressor.of(mirror.gem)
        repeated = [answered(regressor, reading, clip.neutral) for clip, reading in moments]
        still = mirror.neutral()
        shown_of = [_look(mirror, mirror.follow(answer)) for answer in repeated]
        print(f"| {mirror.gem.name} | {grin_of([one.features - still.features for one in shown_of])} |")


def grin_of(features: list[NDArray[np.float32]]) -> str:
    """Cells: how many, the mean of the scores in GRIN and of the lips' distance, of relative features, each [D]."""
    mean = np.mean(features, 0)
    apart = mean[BLOCKS["measures"]][MEASURES.index("lip_gap")]
    scores = " | ".join(f"{float(both(mean, name)):.2f}" for name in GRIN)
    return f"{len(features)} | {scores} | {apart:.2f}"


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
