"""Whether avatars do what others do, where that is known: other avatars act random ARKit shapes before the tracker.

    python tests/bench/known_faces.py [AVATAR.gem ...] [--drivers AVATAR.gem ...] [--pictures 250]

The closed loop asks whether what is read moves along, and an avatar can be read alike with a face that nobody makes.
In each cell: the baseline, then the avatar's regressor. First by how far splats of the head are from where the acted
shapes would have them (RMS, mm), and of how far these would move them; then the weights of shapes that nobody acts
(RMS of their sum of squares), and the splats where nothing is acted and only the head turns (RMS, mm).
"""

import argparse
from pathlib import Path

import numpy as np
from gemheads.models.driver.answer import Express, by_scores
from gemheads.models.driver.networks import FOLDER
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.train.regressors.controls import controls_of
from gemheads.models.train.regressors.response import Responses, at_rest
from gemheads.models.train.regressors.train_regressor import pictures_of
from gemheads.models.train.workers import Workers
from gemheads.render.arrays import Floats

SEED = 7
"""Of the faces; training has seen those of others."""
OF_THE_HEAD = 0.9
"""Least share of the head's turn of the splats that count: shoulders make no faces."""


def main() -> None:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    shipped = sorted((FOLDER.parent / "avatars").glob("*.gem"))
    parser.add_argument("avatars", nargs="*", type=Path, default=shipped, help="who follow; with ARKit shapes")
    parser.add_argument("--drivers", nargs="+", type=Path, default=shipped, help="who act; with ARKit shapes")
    parser.add_argument("--pictures", type=int, default=250, help="of each who acts")
    parser.add_argument("--jobs", type=int, default=1, help="processes that draw")
    asked = parser.parse_args()
    with Workers(asked.jobs) as workers:
        acted = {}
        for gem in map(load_gem, asked.drivers):
            acted[gem.name] = pictures_of(gem, asked.pictures, SEED, workers=workers)
    print(f"| avatar | {' | '.join(acted)} |\n|---|{'---|' * len(acted)}")
    for gem in map(load_gem, asked.avatars):
        cells = (_cell(gem, seen) if name != gem.name else "-" for name, seen in acted.items())
        print(f"| {gem.name} | {' | '.join(cells)} |", flush=True)


def _cell(gem: Gem, seen: Responses) -> str:
    baseline, learned = (figures(gem, express, seen) for express in (by_scores(gem), Regressor.of(gem)))
    (off, should, others, still), own = baseline, learned
    return (
        f"{off:.2f} {own[0]:.2f} of {should:.2f} mm, others {others:.2f} {own[2]:.2f}, rest {still:.2f} {own[3]:.2f} mm"
    )


def figures(gem: Gem, express: Express, seen: Responses) -> tuple[float, float, float, float]:
    """How far off and how far the splats should move, mm; weights that nobody acts; how far they move at rest, mm."""
    answers = np.stack(
        [express(*moment).coefficients for moment in zip(seen.features, seen.seen_rotations, strict=True)]
    )
    controls = controls_of(gem)
    rest, weights = at_rest(seen.weights), controls.weights(answers.astype(np.float32))
    should = [_places(gem, gem.clamped(gem.arkit_coefficients(acted))) for acted in seen.weights]
    does, still = [_places(gem, answer) for answer in answers], _places(gem, gem.rest_coefficients)
    off = np.array([_rms(one - other) for one, other in zip(does, should, strict=True)])
    moved = np.array([_rms(one - still) for one in should])
    others = np.sqrt(np.where(seen.weights == 0, weights**2, 0).sum(1))
    return _rms(off[~rest]), _rms(moved[~rest]), _rms(others[~rest]), _rms(off[rest])


def _places(gem: Gem, coefficients: Floats) -> Floats:
    """[N, 3] splats of the head, mm."""
    splats = gem.compose(np.asarray(coefficients, np.float32))
    return 1000.0 * splats.positions[gem.neck_weights > OF_THE_HEAD]


def _rms(values: Floats) -> float:
    """Of numbers [M], or of lengths of vectors [M, 3]."""
    return float(np.sqrt((values**2).sum() / len(values)))


if __name__ == "__main__":
    main()
