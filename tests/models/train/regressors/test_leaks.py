"""What a turn of the head adds to features: found beside expressions, and invented for heads never seen."""

import numpy as np
import pytest
from gemheads.models.driver.features import DIMENSION

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.expressions import random_weights
from gemheads.models.train.regressors.leaks import TERMS, Leaks, pose_leak, turned
from gemheads.models.train.regressors.response import Responses


@pytest.mark.parametrize("count", [50, 1500])
def test_pose_leak_is_found_beside_expressions(count: int) -> None:
    """Of few pictures where the face rests, of many where it does not."""
    rng = np.random.default_rng(0)
    leak = rng.normal(size=(TERMS, DIMENSION)).astype("f4")
    weights, rotations = random_weights(count, rng), rng.normal(0, 0.2, (count, 3)).astype("f4")
    if count == 50:
        weights[:] = 0
    features = weights @ rng.normal(size=(52, DIMENSION)).astype("f4") + turned(rotations) @ leak
    noisy = features + rng.normal(0, 0.02, features.shape)
    found = pose_leak(Responses(weights, rotations, rotations, noisy.astype("f4")))
    assert np.sqrt(((found - leak) ** 2).mean()) < 0.1


def test_what_is_the_same_to_either_side_is_a_leak_too() -> None:
    """Pursed from the left, pursed from the right."""
    yaw = np.linspace(-0.4, 0.4, 41, dtype="f4")
    rotations = np.stack([0 * yaw, yaw, 0 * yaw], 1)
    pursed = np.repeat(yaw[:, None] ** 2, DIMENSION, 1)
    found = pose_leak(Responses(np.zeros((41, 52), "f4"), rotations, rotations, pursed))
    np.testing.assert_allclose(turned(rotations) @ found, pursed, atol=0.01)


def test_other_heads_differ_as_those_known_do() -> None:
    rng = np.random.default_rng(0)
    known = rng.normal(3, 1, (12, TERMS, DIMENSION)).astype("f4")
    leaks = Leaks(known)
    rotations = np.tile(np.array([[0.1, 0.3, -0.1]], "f4"), (4000, 1))
    added = leaks.of_others(rotations, np.ones(4000, "f4"), rng)
    expected = np.einsum("i,hid->hd", turned(rotations[:1])[0], known)
    np.testing.assert_allclose(added.mean(0), expected.mean(0), atol=0.15)
    np.testing.assert_allclose(added.std(0), expected.std(0), rtol=0.2)
    assert len(np.unique(added[:, 0])) > 3000  # not the known ones again
    alike = leaks.of_others(rotations, np.full(4000, 0.25, "f4"), rng)
    np.testing.assert_allclose(alike.std(0), expected.std(0) / 4, rtol=0.2)
    np.testing.assert_allclose(leaks.of_others(np.zeros((5, 3), "f4"), np.ones(5, "f4"), rng), 0)


def test_a_single_head_is_what_others_are() -> None:
    rng = np.random.default_rng(0)
    known = rng.normal(size=(1, TERMS, DIMENSION)).astype("f4")
    rotations = rng.normal(0, 0.2, (30, 3)).astype("f4")
    np.testing.assert_allclose(
        Leaks(known).of_others(rotations, np.ones(30, "f4"), rng), turned(rotations) @ known[0], atol=1e-4
    )
