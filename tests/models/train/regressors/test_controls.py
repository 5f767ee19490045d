"""What a network steers, from where, and how far."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.driver.baseline import GAIN, baseline_weights
from gemheads.models.driver.features import SCORE_NAMES, SCORES, score
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gemfile import load_gem

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.controls import (  # noqa: E402
    DEEPEST,
    HARDLY_READ,
    HARDLY_READ_REACH,
    STRAIGHT,
    UNREAD,
    Controls,
    controls_of,
)
from gemheads.models.train.regressors.expressions import random_weights  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import network_of, relative_features  # noqa: E402

AVATARS = sorted((Path(__file__).parents[4] / "assets" / "avatars").glob("*.gem"))
GAZES = (("OutLeft", "InRight"), ("InLeft", "OutRight"), ("UpLeft", "UpRight"), ("DownLeft", "DownRight"))
"""Where both eyes look at one thing."""


def test_an_untrained_network_drives_like_the_baseline_with_both_eyes_together() -> None:
    controls = controls_of(toy_gem())
    features = relative_features(10, 2)
    with torch.no_grad():
        weights = network_of(controls, trained=False).weights(torch.from_numpy(features), torch.zeros(10, 3)).numpy()
    eyes = np.array([name.startswith("eyeLook") for name in NAMES])
    np.testing.assert_allclose(weights[:, ~eyes], baseline_weights(features)[:, ~eyes], atol=1e-6)
    for one, other in GAZES:
        pair = [NAMES.index(f"eyeLook{name}") for name in (one, other)]
        scores = [SCORES.start + SCORE_NAMES.index(f"eyeLook{name}") for name in (one, other)]
        wanted = np.clip(GAIN * features[:, scores].mean(1), 0, 1)
        np.testing.assert_allclose(weights[:, pair], np.stack([wanted, wanted], 1), atol=1e-6)


def test_training_moves_both_eyes_as_one() -> None:
    """An avatar that squints may be read a little better."""
    controls = controls_of(toy_gem())
    features, rotations = torch.from_numpy(relative_features(50, 2)), torch.zeros(50, 3)
    with torch.no_grad():
        weights = network_of(controls).weights(features, rotations).numpy()
        start = network_of(controls, trained=False).weights(features, rotations).numpy()
    for one, other in GAZES:
        left, right = NAMES.index(f"eyeLook{one}"), NAMES.index(f"eyeLook{other}")
        assert np.abs(weights - start)[:, left].max() > 0.05
        np.testing.assert_array_equal(weights[:, left], weights[:, right])


@pytest.mark.parametrize("avatar", AVATARS, ids=lambda path: path.stem)
def test_no_avatar_that_ships_squints(avatar: Path) -> None:
    gem = load_gem(avatar)
    regressor = Regressor.of(gem)
    answers = [regressor(features, np.zeros(3, "f4")).coefficients for features in relative_features(40, 4)]
    weights = controls_of(gem).weights(np.stack(answers))
    for one, other in GAZES:
        left, right = NAMES.index(f"eyeLook{one}"), NAMES.index(f"eyeLook{other}")
        np.testing.assert_allclose(weights[:, left], weights[:, right], atol=0.01)


def test_what_the_tracker_does_not_read_stays_still() -> None:
    network = network_of(controls_of(toy_gem()))
    features = torch.from_numpy(relative_features(200, 5) * 5)
    with torch.no_grad():
        moved = (network.weights(features, torch.zeros(200, 3)) - network.started(features)).abs().amax(0).numpy()
    assert (moved[[NAMES.index(name) for name in UNREAD]] == 0).all()
    hardly = moved[[NAMES.index(name) for name in HARDLY_READ]]
    assert (hardly > 0).all()
    assert (hardly <= HARDLY_READ_REACH + 1e-6).all()
    assert moved[NAMES.index("jawOpen")] > HARDLY_READ_REACH


def test_what_falls_below_a_rest_that_reads_as_something_is_not_heeded() -> None:
    """But where somebody looks is, and so is all that an avatar of a capture reads of its own person."""
    features, still = relative_features(20, 1), torch.zeros(20, 3)

    def moved(controls: Controls, name: str) -> float:
        network = network_of(controls)
        fallen = [features.copy() for _ in range(2)]
        for amount, one in zip((DEEPEST, 0.5), fallen, strict=True):
            score(one, name)[...] = -amount
        with torch.no_grad():
            near, far = (network(torch.from_numpy(one), still) for one in fallen)
        return float((near - far).abs().max())

    assert moved(controls_of(toy_gem()), "mouthPucker") == 0
    assert moved(controls_of(toy_gem()), "browInnerUp") == 0
    assert moved(controls_of(toy_gem()), "eyeLookInLeft") > 0
    assert moved(controls_of(toy_gem(rigged=False)), "mouthPucker") > 0


def test_the_weights_of_coefficients_are_found_again() -> None:
    controls = controls_of(load_gem(AVATARS[0]))
    weights = random_weights(300, np.random.default_rng(0))
    np.testing.assert_allclose(controls.weights(controls.coefficients(weights)), weights, atol=2e-3)
    beyond = controls.weights(np.stack([controls.limit, -controls.limit]))
    assert np.isfinite(beyond).all()
    assert (beyond >= controls.lower).all()
    assert (beyond <= controls.upper).all()


@pytest.mark.parametrize("avatar", AVATARS, ids=lambda path: path.stem)
def test_whole_expressions_are_made_whole(avatar: Path) -> None:
    """Equation 4's tanh takes an eighth of a whole smile."""
    gem = load_gem(avatar)
    controls = controls_of(gem)
    for name in ("mouthSmile", "mouthPucker", "eyeBlink", "browInnerUp"):
        weights = np.array([n.startswith(name) for n in NAMES], "f4")
        asked, made = gem.arkit_coefficients(weights), controls.coefficients(weights)
        moved = (asked - gem.rest_coefficients) / controls.limit
        assert (made - gem.rest_coefficients) / controls.limit @ moved / (moved @ moved) > 0.9
        assert (np.abs(made) <= controls.limit).all()
        near = np.abs(asked) < STRAIGHT * controls.limit
        np.testing.assert_allclose(made[near], asked[near], atol=1e-5 * np.abs(asked).max())
