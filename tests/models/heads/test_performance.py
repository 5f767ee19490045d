"""The expressions that an avatar is distilled from."""

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.heads.democlip import RATE, SECONDS, act
from gemheads.models.heads.expressions import weights_of
from gemheads.models.heads.performance import EMOTIONS, VISEMES, gaze, perform, plausible


def test_the_same_seed_performs_the_same() -> None:
    one, two = (perform(np.random.default_rng(7), 250) for _ in range(2))
    np.testing.assert_array_equal(one, two)
    assert one.shape == (250, 52)
    assert one.min() >= 0
    assert one.max() <= 1


def test_every_shape_is_seen_alone_and_fully() -> None:
    performance = perform(np.random.default_rng(7), 250)
    for index, name in enumerate(NAMES):
        alone = np.eye(52, dtype=np.float32)[index]
        if name != "mouthClose":  # means nothing while the jaw is shut
            assert (performance == alone).all(1).any(), name


def test_faces_are_plausible() -> None:
    performance = plausible(np.random.default_rng(2).random((50, 52)).astype(np.float32))
    column = {name: performance[:, NAMES.index(name)] for name in NAMES}
    assert np.all(column["mouthClose"] <= column["jawOpen"])
    assert np.all(np.minimum(column["eyeLookUpLeft"], column["eyeLookDownLeft"]) == 0)
    assert np.all(np.minimum(column["eyeLookInRight"], column["eyeLookOutRight"]) == 0)


def test_looking_left_turns_both_eyes_left() -> None:
    weights = gaze(0.5, -0.25)
    assert weights[NAMES.index("eyeLookOutLeft")] == 0.5
    assert weights[NAMES.index("eyeLookInRight")] == 0.5
    assert weights[NAMES.index("eyeLookDownLeft")] == 0.25
    assert weights.sum() == 1.5


def test_all_named_faces_exist() -> None:
    for face in (*VISEMES.values(), *EMOTIONS.values()):
        weights_of(**face)
    with pytest.raises(ValueError, match="'mouthGrin' is no ARKit weight"):
        weights_of(mouthGrin=1)


def test_the_clip_begins_and_ends_at_rest_and_does_everything_between() -> None:
    acted = np.stack([act(i / RATE)[0] for i in range(round(SECONDS * RATE))])
    assert acted[: int(0.7 * RATE)].max() < 0.05
    assert acted[-1].max() < 0.1
    for name in (
        "jawOpen",
        "mouthSmileLeft",
        "mouthPucker",
        "eyeBlinkLeft",
        "browInnerUp",
        "browDownLeft",
        "eyeLookOutLeft",
    ):
        assert acted[:, NAMES.index(name)].max() > 0.4, name
    turned = np.degrees([np.abs(act(i / RATE)[1]).max() for i in range(round(SECONDS * RATE))])
    assert 12 < turned.max() < 30
