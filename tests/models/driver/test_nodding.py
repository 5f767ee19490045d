"""What an expression only seems to nod is taken off the head's turn."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.answer import by_scores
from gemheads.models.driver.axes import drawn_turn
from gemheads.models.driver.features import DIMENSION, rotation_in_camera, score
from gemheads.models.driver.nodding import MOST_DEG, READ_AS_PITCH_DEG, nodding_of
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of
from toygem import toy_gem

AVATARS = Path(__file__).parents[3] / "assets" / "avatars"
TURN = np.array([0.2, -0.3, 0.1])


def test_each_shape_is_taken_off_the_pitch_alone() -> None:
    gem = load_gem(AVATARS / "mara.gem")
    assert gem.arkit_weights is not None
    nodding = nodding_of(gem)
    for weights in (weights_of(browInnerUp=0.5), weights_of(mouthSmile=0.4, jawOpen=0.3), weights_of(eyeBlink=1.0)):
        seeming = sum(weights_of(**{name: 1.0}) @ weights * degrees for name, degrees in READ_AS_PITCH_DEG.items())
        upright = nodding.taken_off(TURN, gem.rest_coefficients + weights @ gem.arkit_weights)
        np.testing.assert_allclose(upright - TURN, [-np.radians(seeming), 0, 0], atol=1e-3)
    np.testing.assert_array_equal(nodding.taken_off(TURN, gem.rest_coefficients), TURN)


def test_a_shape_that_moves_next_to_nothing_makes_no_nods() -> None:
    gem = load_gem(AVATARS / "mara.gem")
    assert gem.arkit_weights is not None
    numb = gem.arkit_weights.copy()
    numb[NAMES.index("browInnerUp")] *= 1e-6
    nodding = nodding_of(replace(gem, arkit_weights=numb))
    farthest = np.degrees(np.abs(nodding.slopes) * 3 * gem.sigma)
    assert 0.1 < farthest.max() < 4


@pytest.mark.parametrize("strength", [0.0, 1e-41, 1e-6])
def test_an_avatar_whose_shapes_move_next_to_nothing_makes_no_nods(strength: float) -> None:
    gem = load_gem(AVATARS / "mara.gem")
    assert gem.arkit_weights is not None
    numb = replace(gem, arkit_weights=(gem.arkit_weights * strength).astype(np.float32))
    np.testing.assert_array_equal(nodding_of(numb).taken_off(TURN, gem.rest_coefficients + 3 * gem.sigma), TURN)


def test_no_coefficients_make_a_nod_that_no_face_makes() -> None:
    gem = load_gem(AVATARS / "mara.gem")
    nodding = nodding_of(gem)
    upright = nodding.taken_off(TURN, gem.rest_coefficients + 1e3 * np.sign(nodding.slopes) * gem.sigma)
    np.testing.assert_allclose(upright - TURN, [-np.radians(MOST_DEG), 0, 0])


def test_nothing_is_known_of_an_avatar_without_shapes() -> None:
    gem = toy_gem(rigged=False)
    np.testing.assert_array_equal(nodding_of(gem).taken_off(TURN, gem.rest_coefficients + 1), TURN)


@pytest.mark.parametrize("name", ["jonah", "mara", "theo"])
def test_a_still_head_that_acts_seems_to_turn_less(name: str) -> None:
    mirror = Mirror(load_gem(AVATARS / f"{name}.gem"), 384)
    gem, rest = mirror.gem, mirror.neutral()
    nodding = nodding_of(gem)
    seeming, left = [], []
    for weights in (weights_of(browInnerUp=1.0), weights_of(mouthSmile=0.8), weights_of(mouthFrown=1.0)):
        coefficients = gem.arkit_coefficients(weights)
        mirror.restart()
        reading = mirror.read(mirror.draw(coefficients, np.zeros(3)))
        assert reading is not None
        turn = rotation_in_camera(reading.rotation, rest.rotation)
        seeming.append(turn[0])
        left.append(nodding.taken_off(turn, coefficients)[0])
    # What is taken off is the mean of three heads: of a single shape, on one of them, it may be too much.
    assert np.linalg.norm(left) < 0.6 * np.linalg.norm(seeming)
    assert np.abs(left).max() < np.radians(2.0) < np.abs(seeming).max()


def test_the_baseline_turns_as_far_as_the_expression_leaves() -> None:
    gem = load_gem(AVATARS / "theo.gem")
    features = np.zeros(DIMENSION)
    score(features, "browInnerUp")[...] = 1.0
    answer = by_scores(gem)(features, TURN)
    np.testing.assert_array_equal(answer.turn, drawn_turn(nodding_of(gem).taken_off(TURN, answer.coefficients)))
    assert answer.turn[0] > TURN[0] + np.radians(1.5)
    mirror = Mirror(gem, 64)
    np.testing.assert_array_equal(mirror.follow(answer), mirror.draw(answer.coefficients, answer.turn))
