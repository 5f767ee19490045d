"""How people smile, how avatars do, and how much of a whole expression an avatar that is driven shows.

    python tests/bench/smiles.py [CLIP ...] [--avatars AVATAR.gem ...]

models/heads/head.py has what a smile is made of from the first two tables, models/train/regressors/controls.py where
coefficients begin to bend from the third. The last asks an avatar's regressor for the avatar's own expressions: what
it does not give back there, no driver gets.
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from gemheads.app.evaluation.drivers import opened_drivers
from gemheads.models.crossing.kept import Kept
from gemheads.models.crossing.mirror import LOOKS, Mirror
from gemheads.models.driver.features import BLOCKS, score
from gemheads.models.driver.measures import MEASURES
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of
from gemheads.models.train.regressors.controls import STRAIGHT, controls_of
from gemheads.render.arrays import Floats

ROOT = Path(__file__).resolve().parents[2]
DRIVERS = ROOT.parent / "shared" / "data" / "drivers"
EVERY, SECONDS, SIZE = 4, 24.0, 384
SCORES = ((0.15, 0.35), (0.35, 0.55), (0.55, 0.75), (0.75, 1.0))
"""Ranges of the smile's score in which people are put together."""
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
    people([str(path) for path in asked.clips], Kept(asked.cache))
    print("\n| avatar, weight of the smile | smile | mouth wider, cm | corners higher, cm |\n|---|---|---|---|")
    for mirror in mirrors:
        for smile in (0.5, 1.0):
            features = shown(mirror, mouthSmile=smile)
            print(f"| {mirror.gem.name} {smile} | {smile_of(features)} |")
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


def people(clips: list[str], kept: Kept) -> None:
    """Rows of the mean of all frames in which somebody smiles so much, relative to the driver's neutral."""
    clips_read = [driver.tracked(EVERY, SECONDS, kept).clip for driver in opened_drivers(clips)]
    features = np.concatenate([clip.readings.features - clip.neutral.features for clip in clips_read])
    smiles = (score(features, "mouthSmileLeft") + score(features, "mouthSmileRight")) / 2
    for low, high in SCORES:
        chosen = (smiles > low) & (smiles <= high)
        if chosen.any():
            print(f"| {low} to {high} | {chosen.sum()} | {smile_of(features[chosen].mean(0))} |")


def smile_of(features: Floats) -> str:
    """Cells: score, how much wider the mouth is, how much higher its corners, of relative features [D]."""
    smile = (score(features, "mouthSmileLeft") + score(features, "mouthSmileRight")) / 2
    measures = dict(zip(MEASURES, features[BLOCKS["measures"]], strict=True))
    height = (measures["left_corner_height"] + measures["right_corner_height"]) / 2
    return f"{smile:.2f} | {measures['mouth_width']:.2f} | {height:.2f}"


def shown(mirror: Mirror, **weights: float) -> Floats:
    """Relative features [D] of an avatar's expression."""
    picture = mirror.draw(mirror.gem.arkit_coefficients(weights_of(**weights)), np.zeros(3))
    mirror.restart()
    reading = mirror.read(picture, LOOKS)
    assert reading is not None, f"{mirror.gem.name} is not seen"
    return reading.features - mirror.neutral().features


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
