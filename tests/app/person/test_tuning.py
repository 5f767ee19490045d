from dataclasses import replace

import numpy as np
import pytest
from gemheads.app.person.following import EXPRESSION_FILTER, Memory, take_on
from gemheads.app.person.tuning import Tuning, actor_for, gain_matrix, group_of, smoother
from gemheads.models.arkit import NAMES
from gemheads.models.driver.answer import Answer
from gemheads.models.gem import Gem
from gems import ball

from ..scripted import Clock, Person, avatar


@pytest.fixture
def gem() -> Gem:
    """More coefficients than shapes, as real avatars have, so that the shapes can be told apart."""
    plain = ball()
    count = plain.coefficient_count
    weights = np.zeros((52, count), np.float32)
    for shape in ("jawOpen", "browInnerUp", "eyeBlinkLeft"):
        index = NAMES.index(shape)
        weights[index] = np.random.default_rng(index).normal(0, 0.02, count)
    return replace(plain, arkit_weights=weights)


def test_the_middle_of_the_slider_is_what_offline_does() -> None:
    assert smoother(EXPRESSION_FILTER, 0.5) == EXPRESSION_FILTER
    assert smoother(EXPRESSION_FILTER, 1.0).min_cutoff_hz < EXPRESSION_FILTER.min_cutoff_hz / 4
    assert smoother(EXPRESSION_FILTER, 0.0).min_cutoff_hz > EXPRESSION_FILTER.min_cutoff_hz * 4


def test_a_coefficient_that_hardly_varies_poisons_no_gain(gem: Gem) -> None:
    basis = gem.bases["position"]
    still = replace(basis, sigma=np.full_like(basis.sigma, 1e-30))
    matrix = gain_matrix(replace(gem, bases={**gem.bases, "position": still}), Tuning(gains={"mouth": 0.5}))
    assert matrix is not None
    assert np.isfinite(matrix).all()


def test_a_gain_moves_its_group_only(gem: Gem) -> None:
    matrix = gain_matrix(gem, Tuning(gains={"mouth": 0.0, "brows": 2.0}))
    assert matrix is not None
    assert gem.arkit_weights is not None
    for shape, gain in (("jawOpen", 0.0), ("browInnerUp", 2.0), ("eyeBlinkLeft", 1.0)):
        expression = gem.arkit_weights[NAMES.index(shape)].astype(float)
        assert expression @ matrix == pytest.approx(gain * expression, abs=0.03 * np.abs(expression).max())


def test_what_no_shape_explains_stays(gem: Gem) -> None:
    matrix = gain_matrix(gem, Tuning(gains={"mouth": 0.0, "eyes": 0.0, "brows": 0.0}))
    assert matrix is not None
    assert gem.arkit_weights is not None
    shapes = (gem.arkit_weights / gem.sigma)[np.abs(gem.arkit_weights).max(1) > 0]
    other = np.linalg.svd(shapes.astype(float))[2][-1] * gem.sigma
    assert other @ matrix == pytest.approx(other, abs=1e-6)


def test_without_gains_or_without_a_map_nothing_is_multiplied(gem: Gem) -> None:
    assert gain_matrix(gem, Tuning(gains={"head": 0.0, "mouth": 1.0})) is None
    assert gain_matrix(replace(gem, arkit_weights=None), Tuning(gains={"mouth": 0.0})) is None
    assert gain_matrix(gem.truncated(0), Tuning(gains={"mouth": 0.0})) is None


def test_every_shape_has_a_group() -> None:
    assert {group_of(name) for name in NAMES} == {"mouth", "eyes", "brows"}
    assert (group_of("cheekSquintLeft"), group_of("cheekPuff")) == ("eyes", "mouth")


@pytest.mark.parametrize("wrong", [{"smoothing": 1.1}, {"gains": {"ears": 1.0}}, {"gains": {"mouth": float("nan")}}])
def test_a_tuning_no_slider_has_is_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match="no such tuning"):
        Tuning(**wrong)


def test_no_gain_takes_an_expression_beyond_its_limit() -> None:
    plain = avatar()
    actor = actor_for(plain, Person(Clock()), lambda features, turn: answer, Tuning(), hard_to_read=False)
    answer = Answer(2 * plain.gem.sigma, np.zeros(3))
    for gain, sigmas, clamped in ((1.0, 2.0, 0.0), (2.0, 3.0, 1.0)):
        loud = replace(actor, gains=gain * np.eye(plain.gem.coefficient_count))
        memory = take_on(loud, Memory(), answer, 0.0)
        assert memory.expression is not None
        reached = memory.expression.value + plain.gem.rest_coefficients / plain.gem.sigma
        assert reached == pytest.approx(np.full(len(reached), sigmas), abs=1e-4)
        assert memory.clamped == clamped
