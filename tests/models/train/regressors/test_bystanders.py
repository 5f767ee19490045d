"""Heads of other shapes that only turn, drawn and read."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES
from gemheads.models.gemfile import load_gem
from gemheads.render.software import SoftwareEngine

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors import bystanders
from gemheads.models.train.regressors.channels import channel_indices, channel_tolerances
from gemheads.models.train.regressors.controls import controls_of
from gemheads.models.train.regressors.headshape import random_shape
from gemheads.models.train.regressors.leaks import TERMS, turned
from gemheads.models.train.regressors.response import AvatarNotSeen, Sitting, measure_responses
from toygem import toy_gem

MARA = Path(__file__).parents[4] / "assets" / "avatars" / "mara.gem"


def test_each_head_reads_otherwise_when_it_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bystanders, "PICTURES", 24)
    reached: list[tuple[int, int]] = []
    gem = load_gem(MARA)
    leaks = bystanders.leaks_of_bystanders([gem], 3, 3, lambda done, total: reached.append((done, total)))
    again = bystanders.leaks_of_bystanders([gem], 3, 1)
    np.testing.assert_array_equal(leaks.known[:1], again.known)
    assert reached[-1] == (72, 72)
    aside = np.radians(np.array([[0, 20, 0]], "f4"))
    read = (turned(aside) @ leaks.known)[:, 0, channel_indices()] / channel_tolerances()
    assert 0.5 < np.sqrt((read**2).mean()) < 20
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert np.sqrt(((read[one] - read[other]) ** 2).mean()) > 0.3 * np.sqrt((read**2).mean())


def test_a_head_that_nobody_sees_is_left_out_and_without_any_nothing_is_known() -> None:
    with pytest.raises(AvatarNotSeen, match="no face in pictures of 'toy' at rest"):
        bystanders.leaks_of_bystanders([toy_gem()], 0, 2)
    leaks = bystanders.leaks_of_bystanders([load_gem(MARA), toy_gem()], 0, 2)
    assert len(leaks.known) == 1


def test_of_people_less_is_believed_where_avatars_exaggerate() -> None:
    leak = np.ones((TERMS, DIMENSION), "f4")
    share = bystanders.believed(leak)
    assert (share[:, BLOCKS["gaze"]] == bystanders.BELIEVED_GAZE).all()
    lowered = SCORES.start + SCORE_NAMES.index("browDownLeft")
    assert (share[:, lowered] == bystanders.BELIEVED["browDownLeft"]).all()
    assert (share == 1).mean() > 0.9
    assert (leak == 1).all()


def test_who_sits_before_which_camera_is_what_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """A head fills the picture whatever the field of view; a head of another shape is drawn as such."""
    gem = load_gem(MARA)
    drawn: list[tuple[np.ndarray, float]] = []
    plain = SoftwareEngine.draw

    def drawing(engine, gaussians, camera):
        distance = np.linalg.norm(camera.center - gem.viewing.target)
        drawn.append((gaussians.positions.copy(), float(distance)))
        return plain(engine, gaussians, camera)

    monkeypatch.setattr(SoftwareEngine, "draw", drawing)
    weights, rng = np.zeros((1, 52), "f4"), np.random.default_rng(0)
    shape = random_shape(rng)
    sittings = (Sitting(), Sitting(60.0), Sitting(shape=shape))
    for sitting in sittings:
        measure_responses(gem, controls_of(gem), weights, rng, rotations=np.zeros((1, 3), "f4"), sitting=sitting)
    (own, far), (same, near), (other, as_far) = drawn[::2]
    assert far == pytest.approx(as_far)
    assert 2.5 < far / near < 4
    np.testing.assert_array_equal(own, same)
    np.testing.assert_allclose(other - own, shape.displacement(own, gem.viewing), atol=1e-5)
