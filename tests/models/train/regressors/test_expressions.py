"""The random faces that avatars are drawn with: what they cover decides what a regressor knows."""

import numpy as np
from gemheads.models.arkit import NAMES
from gemheads.models.train.regressors.controls import controls_of
from gemheads.models.train.regressors.expressions import OF_MOUTH, random_coefficients, random_weights
from toygem import toy_gem


def test_random_faces_cover_every_weight_and_start_neutral() -> None:
    weights = random_weights(2000, np.random.default_rng(0))
    assert (weights[0] == 0).all()
    assert weights.min() >= 0
    assert weights.max() <= 1
    assert (weights.std(0) > 0.02).all(), [n for n, s in zip(NAMES, weights.std(0), strict=True) if s <= 0.02]
    np.testing.assert_array_equal(weights, random_weights(2000, np.random.default_rng(0)))


def test_any_two_movements_of_the_mouth_are_done_together() -> None:
    """What no compound lists, too: a regressor would use it without knowing how it is read."""
    weights = random_weights(16_000, np.random.default_rng(0))
    done = np.stack([weights[:, places].min(1) > 0.3 for places in OF_MOUTH])
    together = done.astype(int) @ done.T
    assert together.min() >= 40, [NAMES[OF_MOUTH[i][0]] for i in np.unravel_index(together.argmin(), together.shape)]


def test_teeth_are_bared_with_the_jaw_closed() -> None:
    """How they are read does not follow from teeth behind an open jaw; grins and hissed sounds are nothing rare."""
    weights = random_weights(6000, np.random.default_rng(0))
    upper, lower = (
        np.minimum(*(weights[:, NAMES.index(f"{lip}{half}")] for half in ("Left", "Right")))
        for lip in ("mouthUpperUp", "mouthLowerDown")
    )
    closed = weights[:, NAMES.index("jawOpen")] < 0.05
    assert (closed & (upper > 0.3) & (lower > 0.3)).sum() >= 60
    assert (closed & (upper > 0.7)).sum() >= 60


def test_whole_smiles_are_nothing_rare() -> None:
    """Of a score that has all but ended the rest must be learned from other channels, and from many."""
    weights = random_weights(4000, np.random.default_rng(0))
    smile = np.minimum(*(weights[:, NAMES.index(f"mouthSmile{half}")] for half in ("Left", "Right")))
    assert (smile > 0.6).mean() > 0.08
    teeth = weights[:, NAMES.index("mouthUpperUpLeft")] > 0.3
    assert 0.2 < teeth[smile > 0.6].mean() < 0.8


def test_random_coefficients_respect_their_bounds() -> None:
    controls = controls_of(toy_gem(rigged=False))
    weights = random_coefficients(controls, 500, np.random.default_rng(0))
    assert (np.abs(weights) <= controls.upper).all()
    assert (weights.std(0) > 0.2 * controls.upper).all()
