"""What a turned head only seems to do on one side."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models import arkit
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.features import feature_vector, score
from gemheads.models.driver.points import SCORES
from gemheads.models.driver.sides import FRONTAL_RAD, believed_sides
from gemheads.models.gemfile import load_gem
from gemheads.models.train.regressors.controls import controls_of
from numpy.typing import NDArray

AVATARS = Path(__file__).parents[3] / "assets" / "avatars"


def scored(**named: float) -> NDArray[np.float32]:
    return np.array([named.get(name, 0.05) for name in SCORES], np.float32)


def sides(scores: NDArray[np.float32], name: str) -> list[float]:
    return [float(scores[SCORES.index(name + side)]) for side in ("Left", "Right")]


@pytest.mark.parametrize("name", ["mouthPress", "mouthDimple"])
@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_lips_and_cheeks_do_the_same_on_both_sides(name: str, yaw: float) -> None:
    believed = believed_sides(scored(**{f"{name}Left": 0.8, f"{name}Right": 0.2}), yaw)
    assert sides(believed, name) == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize("name", ["mouthPress", "mouthDimple", "browOuterUp"])
@pytest.mark.parametrize("both", [0.02, 0.2, 0.6])
def test_what_a_turn_adds_to_one_side_and_takes_from_the_other_is_nothing(name: str, both: float) -> None:
    logit, aside = np.log(both / (1 - both)), np.radians(90)
    left, right = (float(1 / (1 + np.exp(-logit - shift))) for shift in (-1.5, 1.5))
    believed = believed_sides(scored(**{f"{name}Left": left, f"{name}Right": right}), aside)
    assert sides(believed, name) == pytest.approx([both, both], abs=0.005)


@pytest.mark.parametrize("pair", [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
def test_scores_of_nothing_and_of_all_are_heeded_as_others(pair: tuple[float, float]) -> None:
    left, right = pair
    believed = believed_sides(scored(mouthPressLeft=left, mouthPressRight=right), 0.3)
    assert sides(believed, "mouthPress") == pytest.approx([np.mean(pair)] * 2, abs=1e-3)


@pytest.mark.parametrize(("turned", "left", "right"), [(0.0, 0.8, 0.2), (1.0, 0.65, 0.35), (2.0, 0.56, 0.44)])
@pytest.mark.parametrize("to_side", [-1, 1])
def test_a_single_brow_is_believed_from_the_front(turned: float, left: float, right: float, to_side: int) -> None:
    raised = scored(browOuterUpLeft=0.8, browOuterUpRight=0.2)
    believed = believed_sides(raised, to_side * turned * FRONTAL_RAD)
    assert sides(believed, "browOuterUp") == pytest.approx([left, right])


def test_all_else_is_as_it_is_read_and_so_are_the_scores_themselves() -> None:
    scores = np.random.default_rng(0).uniform(0, 1, len(SCORES)).astype(np.float32)
    before = scores.copy()
    believed = believed_sides(scores, 0.3)
    others = [name for name in SCORES if not name.startswith(("mouthPress", "mouthDimple", "browOuterUp"))]
    places = [SCORES.index(name) for name in others]
    np.testing.assert_array_equal(believed[places], scores[places])
    np.testing.assert_array_equal(scores, before)


@pytest.mark.parametrize("name", ["jonah", "mara", "theo"])
def test_who_raises_both_brows_and_turns_raises_both(name: str) -> None:
    gem = load_gem(AVATARS / f"{name}.gem")
    mirror, raised = Mirror(gem, 384), np.zeros((1, len(arkit.NAMES)), np.float32)
    raised[0, [arkit.NAMES.index(f"browOuterUp{side}") for side in ("Left", "Right")]] = 0.5
    coefficients = controls_of(gem).coefficients(raised)[0]
    read, believed = [], []
    for yaw in (-14, 14):
        tracker, picture = FaceTracker(), mirror.draw(coefficients, np.radians([0.0, yaw, 0.0]))
        tracker.track(picture)
        face = tracker.track(picture)
        assert face is not None
        left, right = sides(face.scores, "browOuterUp")
        read.append(left - right)
        features = feature_vector(face)
        believed.append(float(score(features, "browOuterUpLeft") - score(features, "browOuterUpRight")))
    seeming, left_over = (read[1] - read[0]) / 2, abs(believed[1] - believed[0]) / 2
    if name != "jonah":  # whose brows the tracker reads less unlike, by .041: of him only what is left is asked
        assert seeming > 0.05, "the tracker reads both alike: nothing to mend"
    assert left_over < seeming / 4
    assert left_over < 0.0125
