"""Portraits: an avatar drawn as people get to see it, of which its turns are learned."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.driver.regressor import Regressor, RegressorError
from gemheads.models.gemfile import load_gem, save_gem

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.driver.axes import drawn_turn  # noqa: E402
from gemheads.models.train.regressors import response  # noqa: E402
from gemheads.models.train.regressors.controls import controls_of  # noqa: E402
from gemheads.models.train.regressors.response import ITSELF, PORTRAIT, measure_responses  # noqa: E402
from gemheads.models.train.regressors.train_turns import train_turns  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import relative_features  # noqa: E402

AVATARS = Path(__file__).parents[4] / "assets" / "avatars"


def test_portraits_differ_in_pose_and_expression_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    gem, rng = load_gem(AVATARS / "theo.gem"), np.random.default_rng(0)
    turns: list[np.ndarray] = []
    posed = response.pose_head

    def posing(raw, weights, pivot, rotation, translation):
        turns.append(np.asarray(rotation))
        return posed(raw, weights, pivot, rotation, translation)

    monkeypatch.setattr(response, "pose_head", posing)
    weights, asked = np.zeros((2, 52), "f4"), np.array([[0, 0.3, 0.1]] * 2, "f4")
    one, other = measure_responses(gem, controls_of(gem), weights, rng, rotations=asked, sitting=PORTRAIT).features
    np.testing.assert_array_equal(one, other)
    np.testing.assert_allclose(turns[1:], [drawn_turn(asked[0])] * 2)
    seen = measure_responses(gem, controls_of(gem), weights, rng, rotations=asked, sitting=ITSELF)
    assert np.abs(seen.features[0] - seen.features[1]).max() > 0.01
    np.testing.assert_array_equal(turns[4:], asked)


def test_an_avatar_learns_its_turns_anew_and_answers_as_before() -> None:
    path = AVATARS / "theo.gem"
    before = load_gem(path)
    after, turns = train_turns(path, pictures=200, steps=300, seed=1)
    assert 250 < turns.portraits <= 270
    assert (turns.left_deg < turns.missed_deg).all()
    features, aside = relative_features(1)[0], np.array([0, 0.3, 0])
    former, anew = (Regressor.of(gem)(features, aside) for gem in (before, after))
    np.testing.assert_array_equal(former.coefficients, anew.coefficients)
    assert 0 < np.abs(former.turn - anew.turn).max() < np.radians(4)


@pytest.mark.parametrize("graph", [None, b"no graph"])
def test_an_avatar_without_a_regressor_of_use_learns_no_turns(graph: bytes | None, tmp_path: Path) -> None:
    save_gem(replace(toy_gem(), regressor=graph), tmp_path / "toy.gem")
    with pytest.raises(RegressorError, match=r"has no regressor|cannot be used"):
        train_turns(tmp_path / "toy.gem")
