"""Invented people: what is read on them, and what of it an avatar shall follow."""

from dataclasses import replace

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES
from gemheads.models.driver.measures import MEASURES

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors import strangers
from gemheads.models.train.regressors.channels import channel_indices, mouth_channels
from gemheads.models.train.regressors.leaks import TERMS, Leaks, pose_leak, turned
from gemheads.models.train.regressors.strangers import (
    MOUTH_SPREAD,
    Crowd,
    Person,
    crowd,
    expressed,
    in_tolerances,
)
from linearperson import linear_person


def alone(person: Person) -> Leaks:
    """Nobody else's head turns otherwise."""
    return Leaks(pose_leak(person.seen)[None])


def test_invented_people_move_their_scores_otherwise_than_the_avatar() -> None:
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    person = linear_person(shapes, leak)
    people = crowd([person, person], alone(person), np.empty((0, DIMENSION + 3), "f4"), 500, rng)
    assert people.features.shape == (500, DIMENSION)
    assert people.wanted.shape == (500, len(channel_indices()))
    assert np.isfinite(people.features).all()
    assert 0.5 < people.features.std() / person.seen.features.std() < 2


def test_a_crowd_invented_in_parts_is_as_large_and_as_varied(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    person = linear_person(*(rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3)))
    monkeypatch.setattr(strangers, "AT_ONCE", 60)
    people = crowd([person], alone(person), np.empty((0, DIMENSION + 3), "f4"), 200, rng)
    assert [len(array) for array in vars(people).values()] == [200] * 6
    assert len(np.unique(people.features, axis=0)) == 200


def test_what_people_act_is_known_where_their_shapes_are_the_avatars() -> None:
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    plain = linear_person(shapes, leak)
    shaped, nobody = replace(plain, arkit=True), np.empty((0, DIMENSION + 3), "f4")
    for cast, known in (((shaped, shaped), 1.0), ((shaped, plain), 0.5), ((plain, shaped), 0.0)):
        people = crowd(cast, alone(plain), nobody, 2000, np.random.default_rng(1))
        told = np.isfinite(people.acted).all(1)
        assert abs(told.mean() - known) < 0.05
        assert np.isnan(people.acted[~told]).all()
        assert (people.acted[told & people.resting] == 0).all()
    people = crowd([shaped], alone(plain), nobody, 2000, np.random.default_rng(1))
    one, of_all = (
        rows / (np.linalg.norm(rows, axis=1, keepdims=True) + 1e-9) for rows in (people.acted, plain.seen.weights)
    )
    acting = ~people.resting
    assert ((one @ of_all.T).max(1)[acting] > 0.999).all()  # somebody's picture, as a whole more or less strongly done
    footage = np.zeros((5, DIMENSION + 3), "f4")
    assert np.isnan(crowd([shaped], alone(plain), footage, 2000, rng).acted).all(1).mean() == pytest.approx(
        1 / 3, abs=0.05
    )


def test_every_picture_is_used_as_often_where_that_is_wanted() -> None:
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    many = linear_person(shapes, leak)
    few = replace(many, seen=many.seen.only(np.arange(len(many.seen)) % 9 == 0))
    told = replace(few, seen=replace(few.seen, seen_rotations=np.full_like(few.seen.rotations, 7)))
    nobody = np.empty((0, DIMENSION + 3), "f4")
    for by_pictures, share in ((False, 0.5), (True, len(few.seen) / (len(few.seen) + len(many.seen)))):
        people = crowd([many, told], alone(many), nobody, 2000, np.random.default_rng(1), by_pictures)
        assert abs((people.rotations == 7).all(1).mean() - share) < 0.05


def test_what_shall_be_followed_is_free_of_the_turn_of_the_head() -> None:
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    person = linear_person(shapes, leak)
    wanted = expressed(person)
    np.testing.assert_allclose(wanted, in_tolerances(person.seen.weights @ shapes), atol=2e-2)
    assert np.abs(in_tolerances(person.seen.features) - wanted).max() > 10
    seen = person.seen
    turning = replace(seen, weights=np.full_like(seen.weights, 1e-6), features=seen.rotations @ leak)  # hardly at rest
    np.testing.assert_allclose(expressed(Person(turning, person.response)), 0, atol=2e-2)
    footage = np.concatenate([turning.features, turning.rotations], 1)
    people = crowd([Person(turning, person.response)], alone(person), footage, 500, rng)
    assert np.abs(people.wanted).max() < 0.1 * np.abs(in_tolerances(people.features)).max()


def test_the_leak_of_who_is_seen_is_exchanged_for_that_of_others() -> None:
    """What shall be followed does not depend on whose head it is."""
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    person = linear_person(shapes, leak)
    others = rng.normal(size=(1, TERMS, DIMENSION)).astype("f4")

    def people(known: np.ndarray) -> Crowd:
        return crowd([person], Leaks(known), np.empty((0, DIMENSION + 3), "f4"), 400, np.random.default_rng(3))

    still, turning = people(0 * others), people(others)
    np.testing.assert_array_equal(still.wanted, turning.wanted)
    gained = (turning.features - still.features) / (turned(turning.rotations) @ others[0])
    assert (gained[np.abs(turning.rotations).min(1) > 0.02] > 0).mean() > 0.99  # gains, and hardly noise
    own = people(pose_leak(person.seen)[None])
    assert np.abs(own.features - still.features).max() > 1


def test_people_turn_as_they_are_read_and_leak_as_they_turn() -> None:
    """A smile is read as a head that looks up; what its turn adds to features is that of the true one."""
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    person = linear_person(shapes, leak)
    nodding = replace(person, seen=replace(person.seen, seen_rotations=person.seen.rotations + np.float32(0.07)))
    others, nobody = Leaks(rng.normal(size=(3, TERMS, DIMENSION)).astype("f4")), np.empty((0, DIMENSION + 3), "f4")
    plain, read = (crowd([one], others, nobody, 200, np.random.default_rng(3)) for one in (person, nodding))
    np.testing.assert_allclose(read.rotations - plain.rotations, 0.07, atol=1e-6)
    np.testing.assert_array_equal(read.turns, plain.turns)
    np.testing.assert_array_equal(plain.turns, plain.rotations)
    np.testing.assert_array_equal(read.features, plain.features)
    np.testing.assert_array_equal(read.wanted, plain.wanted)


def test_faces_at_rest_turn_as_more_differing_heads_than_those_that_act() -> None:
    rng = np.random.default_rng(0)
    shapes = rng.normal(size=(len(NAMES), DIMENSION)).astype("f4")
    person = linear_person(0 * shapes, np.zeros((3, DIMENSION), "f4"), 4000)
    rest = np.arange(4000) % 2 == 0
    weights = np.where(rest[:, None], 0, np.maximum(person.seen.weights, 1e-3))
    known = np.stack([np.ones((TERMS, DIMENSION)), -np.ones((TERMS, DIMENSION))]).astype("f4")
    someone = replace(person, seen=replace(person.seen, weights=weights))
    people = crowd([someone], Leaks(known), np.empty((0, DIMENSION + 3), "f4"), 4000, rng)
    turn = np.abs(turned(people.rotations).sum(1)) > 0.3
    added = np.abs(people.features[:, SCORES].mean(1) / turned(people.rotations).sum(1))
    acting, resting = (added[turn & who].mean() for who in (~people.resting, people.resting))
    assert acting / resting == pytest.approx(strangers.LEAK_SPREAD / strangers.RESTING_LEAK_SPREAD, rel=0.1)


def test_of_a_face_at_rest_nothing_is_followed() -> None:
    """Whatever is read there: light, framing and the turn of the head."""
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    person = linear_person(shapes, leak)
    rest = np.arange(len(person.seen)) % 4 == 0
    read = person.seen.features + rng.normal(0, 1, person.seen.features.shape).astype("f4")
    weights = np.where(rest[:, None], 0, np.maximum(person.seen.weights, 1e-3))
    someone = replace(person, seen=replace(person.seen, weights=weights, features=read))
    wanted = expressed(someone)
    assert (wanted[rest] == 0).all()
    assert (np.abs(wanted[~rest]).max(1) > 1).all()
    people = crowd([someone], alone(someone), np.empty((0, DIMENSION + 3), "f4"), 800, rng)
    assert 0.2 < people.resting.mean() < 0.3
    assert (people.wanted[people.resting] == 0).all()
    assert (np.abs(people.features[people.resting]).max(1) > 1).all()
    footage = np.concatenate([read, person.seen.rotations], 1)
    filmed = crowd([someone], alone(someone), footage, 800, rng)
    assert 0.1 < filmed.resting.mean() < 0.23  # of strangers in a film nobody knows when they rest


def test_mouths_go_together_otherwise_and_that_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is read and what shall be followed differ from the avatars' alike, the more the more moves; nothing else."""
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(size=(rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    person = linear_person(shapes, leak)
    weights = np.where(np.arange(len(person.seen))[:, None] % 4 == 0, 0, np.maximum(person.seen.weights, 1e-3))
    someone = replace(person, seen=replace(person.seen, weights=weights))

    def people(spread: float) -> Crowd:
        monkeypatch.setattr(strangers, "MOUTH_SPREAD", spread)
        return crowd([someone], alone(someone), np.empty((0, DIMENSION + 3), "f4"), 4000, np.random.default_rng(3))

    plain, other = people(0.0), people(MOUTH_SPREAD)
    mouth, resting = mouth_channels(), plain.resting
    followed = other.wanted - plain.wanted
    np.testing.assert_allclose(in_tolerances(other.features - plain.features), followed, atol=0.02 * followed.std())
    assert (followed[:, ~mouth] == 0).all()
    assert (followed[resting] == 0).all()
    moving = plain.wanted[~resting][:, mouth]
    assert 0.3 < followed[~resting][:, mouth].std() / moving.std() < 1
    order = np.argsort((moving**2).sum(1))
    still, lively = (np.abs(followed[~resting][rows][:, mouth]).mean() for rows in (order[:500], order[-500:]))
    assert lively > 2 * still


def test_the_channels_of_the_mouth_are_those_of_lips_and_jaw() -> None:
    places = channel_indices()[mouth_channels()]
    assert SCORES.start + SCORE_NAMES.index("jawOpen") in places
    assert BLOCKS["measures"].start + MEASURES.index("lip_gap") in places
    others = channel_indices()[~mouth_channels()]
    assert SCORES.start + SCORE_NAMES.index("browInnerUp") in others
    assert BLOCKS["measures"].start + MEASURES.index("left_lid_gap") in others
    assert set(range(BLOCKS["gaze"].start, BLOCKS["gaze"].stop)) <= set(others)
