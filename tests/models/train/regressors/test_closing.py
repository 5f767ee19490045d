"""The closed loop as a loss: several models of one response, and a network that they judge in turn."""

import copy
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.arkit import NAMES, PARTNERS  # noqa: E402
from gemheads.models.driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES  # noqa: E402
from gemheads.models.driver.measures import MEASURES  # noqa: E402
from gemheads.models.train.regressors import closing  # noqa: E402
from gemheads.models.train.regressors.channels import (  # noqa: E402
    AGAPE_TOLERANCE,
    LIP_TOLERANCE,
    PARTED,
    channel_indices,
    channel_tolerances,
)
from gemheads.models.train.regressors.closing import BELOW, ClosedLoop, descend  # noqa: E402
from gemheads.models.train.regressors.controls import DEEPEST, UNBOUNDED, controls_of  # noqa: E402
from gemheads.models.train.regressors.expressions import random_weights  # noqa: E402
from gemheads.models.train.regressors.network import RegressorNetwork  # noqa: E402
from gemheads.models.train.regressors.reduction import Reduction, principal_components  # noqa: E402
from gemheads.models.train.regressors.response import HUBER, ResponseModel, Responses  # noqa: E402
from gemheads.models.train.regressors.strangers import Crowd, Person, expressed, in_tolerances  # noqa: E402
from gemheads.models.train.regressors.train_regressor import person_of  # noqa: E402
from toygem import toy_gem  # noqa: E402

COUNT = 600


def answering(shapes: np.ndarray) -> ResponseModel:
    """A response that is linear in the weights alone."""
    response = ResponseModel(len(NAMES), shapes.shape[1])
    with torch.no_grad():
        for parameter in response.parameters():
            parameter.zero_()
        response.linear.weight[:, : len(NAMES)] = torch.from_numpy(shapes.T)
    return response.requires_grad_(False)


@pytest.fixture(scope="module")
def scene() -> tuple[RegressorNetwork, Person, Crowd]:
    """An avatar whose face follows its weights linearly, and people who do with theirs what it should do."""
    rng = np.random.default_rng(0)
    weights = random_weights(COUNT, rng)
    features = (weights @ rng.normal(0, 0.2, (len(NAMES), DIMENSION))).astype("f4")
    wanted = in_tolerances(features)
    shapes = np.linalg.lstsq(weights, wanted, rcond=None)[0].astype("f4")
    front = np.zeros((COUNT, 3), "f4")
    seen = Responses(weights, front, front, features)
    torch.manual_seed(0)
    network = RegressorNetwork(principal_components(features), controls_of(toy_gem()))
    unknown = np.full_like(weights, np.nan)
    people = Crowd(features, seen.rotations, wanted, ~weights.any(1), seen.rotations, unknown)
    return network, Person(seen, answering(shapes)), people


def test_training_closes_the_loop(scene: tuple[RegressorNetwork, Person, Crowd]) -> None:
    network, avatar, people = scene
    loop = ClosedLoop(network, avatar, people)
    before = loop.mismatch()
    descend(network, loop.loss, 150, lambda stage, done, total: None)
    assert loop.mismatch() < 0.6 * before
    untrained = RegressorNetwork(
        Reduction(network.feature_mean.numpy(), network.projection.numpy()), controls_of(toy_gem())
    )
    assert (
        loop.mismatch([network]) == loop.mismatch() < loop.mismatch([network, untrained]) < loop.mismatch([untrained])
    )


def test_a_mouth_that_is_open_counts_less_for_being_wider(scene: tuple[RegressorNetwork, Person, Crowd]) -> None:
    network, avatar, people = scene
    closed = replace(avatar, response=answering(np.zeros((len(NAMES), people.wanted.shape[1]), "f4")))
    lips = list(channel_indices()).index(BLOCKS["measures"].start + MEASURES.index("lip_gap"))

    def mismatch(gap: float) -> float:
        wanted = np.zeros_like(people.wanted)
        wanted[:, lips] = gap / channel_tolerances()[lips]
        return ClosedLoop(network, closed, replace(people, wanted=wanted)).mismatch() * len(channel_indices())

    # beyond HUBER tolerances each costs HUBER
    assert mismatch(PARTED + AGAPE_TOLERANCE) - mismatch(PARTED) == pytest.approx(HUBER, rel=1e-3)
    near = mismatch(PARTED) - mismatch(PARTED - LIP_TOLERANCE)
    assert near == pytest.approx(HUBER, rel=1e-3)


class Turning(ResponseModel):
    """A response of which a turned head shows half of the expression, and something of its own."""

    def __init__(self, shapes: np.ndarray) -> None:
        super().__init__(*shapes.shape)
        self.shapes = torch.from_numpy(shapes)

    def forward(self, weights: torch.Tensor, rotation: torch.Tensor) -> torch.Tensor:
        aside = (rotation[:, 1:2].abs() > 0.1).float()
        return weights @ self.shapes * (1 - aside / 2) + 20 * aside


def test_an_avatar_is_judged_turned_as_its_driver_is(scene: tuple[RegressorNetwork, Person, Crowd]) -> None:
    """Who drives himself is followed by what he acts, however much of it his turned head hides."""
    network, avatar, people = scene
    shapes = avatar.response.linear.weight[:, : len(NAMES)].T.numpy().copy()
    turns = np.tile(np.array([[0, 0.3, 0], [0, 0, 0]], "f4"), (COUNT // 2, 1))
    weights = torch.from_numpy(avatar.seen.weights)
    response = Turning(shapes).requires_grad_(False)
    rest = response(torch.zeros(1, len(NAMES)), torch.zeros(1, 3))
    features = np.zeros((COUNT, DIMENSION), "f4")
    features[:, channel_indices()] = (response(weights, torch.from_numpy(turns)) - rest).numpy() * channel_tolerances()
    himself = Person(replace(avatar.seen, rotations=turns, features=features), response)
    wanted = expressed(himself)

    class Actor(RegressorNetwork):
        def weights(self, features: torch.Tensor, rotation: torch.Tensor) -> torch.Tensor:
            return weights

    actor = Actor(Reduction(network.feature_mean.numpy(), network.projection.numpy()), controls_of(toy_gem()))
    actor.least.fill_(UNBOUNDED)  # whatever falls is followed
    seen = replace(people, features=features, rotations=turns, wanted=wanted, turns=turns)
    assert ClosedLoop(actor, himself, seen).mismatch([actor]) < 1e-5
    facing = replace(seen, turns=np.zeros_like(turns))
    assert ClosedLoop(actor, himself, facing).mismatch([actor]) > 0.1


def test_what_falls_below_what_is_heeded_is_asked_for_in_part(scene: tuple[RegressorNetwork, Person, Crowd]) -> None:
    network, avatar, people = scene
    still = replace(avatar, response=answering(np.zeros((len(NAMES), people.wanted.shape[1]), "f4")))
    gaze = SCORES.start + SCORE_NAMES.index("eyeLookDownLeft")  # is heeded however far it falls

    def mismatch(channel: int, relative: float) -> float:
        wanted = np.zeros_like(people.wanted)
        place = list(channel_indices()).index(channel)
        wanted[:, place] = relative / channel_tolerances()[place]
        return ClosedLoop(network, still, replace(people, wanted=wanted)).mismatch()

    pucker = SCORES.start + SCORE_NAMES.index("mouthPucker")
    assert mismatch(pucker, -DEEPEST) == pytest.approx(mismatch(pucker, DEEPEST), rel=1e-4)
    deeper = -DEEPEST - 0.04
    assert mismatch(pucker, deeper) == pytest.approx(mismatch(pucker, DEEPEST + BELOW * 0.04), rel=1e-4)
    assert mismatch(pucker, deeper) < 0.8 * mismatch(pucker, -deeper)
    assert mismatch(gaze, -0.3) == pytest.approx(mismatch(gaze, 0.3), rel=1e-4)
    assert np.isfinite(mismatch(BLOCKS["measures"].start + MEASURES.index("lip_gap"), -0.4))


def test_what_follows_best_is_found_without_a_network(
    scene: tuple[RegressorNetwork, Person, Crowd], monkeypatch: pytest.MonkeyPatch
) -> None:
    trained, avatar, people = scene
    monkeypatch.setattr(closing, "AT_ONCE", 250)
    network = RegressorNetwork(
        Reduction(trained.feature_mean.numpy(), trained.projection.numpy()), controls_of(toy_gem())
    )
    loop = ClosedLoop(network, avatar, people)
    untrained = loop.mismatch()
    best = loop.best()
    assert best.shape == (COUNT, len(NAMES))
    assert best.dtype == np.float32
    assert (best >= 0).all()
    assert (best <= 1).all()
    start = network.started(torch.from_numpy(people.features)).numpy()
    assert (np.abs(best - start) <= network.reach.numpy() + 1e-6).all()
    shown = avatar.response(torch.from_numpy(best), torch.zeros(COUNT, 3)).numpy()
    missed = np.abs(shown - people.wanted)
    assert np.where(missed < 3, missed**2 / 2, 3 * (missed - 1.5)).mean() < 0.3 * untrained
    for eyes in (("eyeLookOutLeft", "eyeLookInRight"), ("eyeLookUpLeft", "eyeLookUpRight")):
        one, other = (best[:, NAMES.index(name)] - start[:, NAMES.index(name)] for name in eyes)
        inside = (best[:, [NAMES.index(name) for name in eyes]] % 1 != 0).all(1)
        np.testing.assert_allclose(one[inside], other[inside], atol=1e-5)


def test_the_halves_of_a_face_are_moved_together(
    scene: tuple[RegressorNetwork, Person, Crowd], monkeypatch: pytest.MonkeyPatch
) -> None:
    trained, avatar, people = scene
    reduction = Reduction(trained.feature_mean.numpy(), trained.projection.numpy())
    seen = torch.from_numpy(people.features), torch.from_numpy(people.rotations)

    def apart(price: float) -> float:
        monkeypatch.setattr(closing, "ONE_SIDED", price)
        torch.manual_seed(0)
        network = RegressorNetwork(reduction, controls_of(toy_gem()))
        descend(network, ClosedLoop(network, avatar, people).loss, 150, lambda stage, done, total: None)
        with torch.no_grad():
            moved = network.weights(*seen) - network.started(seen[0])
        left, right = np.array(PARTNERS).T
        return float((moved[:, left] - moved[:, right]).square().mean())

    assert apart(100.0) < 0.5 * apart(0.0)


def test_an_avatar_that_is_steered_by_coefficients_has_no_halves(
    scene: tuple[RegressorNetwork, Person, Crowd],
) -> None:
    controls = controls_of(toy_gem(rigged=False))
    assert len(controls.pairs) == 0
    _, avatar, people = scene
    network = RegressorNetwork(principal_components(people.features), controls)
    count = len(controls.upper)
    response = ResponseModel(count, people.wanted.shape[1]).requires_grad_(False)
    seen = replace(avatar.seen, weights=np.zeros((COUNT, count), "f4"))
    unknown = replace(people, acted=np.full((COUNT, count), np.nan, "f4"))
    assert torch.isfinite(ClosedLoop(network, Person(seen, response), unknown).loss())


def test_of_all_that_would_read_alike_what_is_acted_is_best(
    scene: tuple[RegressorNetwork, Person, Crowd], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two shapes that the tracker cannot tell apart: the face that people make is known all the same."""
    _, avatar, people = scene
    one, other = NAMES.index("mouthFrownLeft"), NAMES.index("mouthPressLeft")
    shapes = avatar.response.linear.weight[:, : len(NAMES)].T.numpy().copy()
    shapes[other] = shapes[one]
    weights = np.zeros((COUNT, len(NAMES)), "f4")
    weights[:, one] = np.linspace(0, 0.6, COUNT)
    alike = replace(people, wanted=weights @ shapes, features=np.zeros_like(people.features), acted=weights)

    def astray(price: float) -> float:
        monkeypatch.setattr(closing, "ACTED", price)
        network = RegressorNetwork(principal_components(people.features), controls_of(toy_gem()))
        return float(ClosedLoop(network, Person(avatar.seen, answering(shapes)), alike).best()[:, other].mean())

    assert astray(30.0) < 0.5 * astray(0.0)


def test_a_face_that_moves_where_only_the_head_does_is_dear(
    scene: tuple[RegressorNetwork, Person, Crowd], monkeypatch: pytest.MonkeyPatch
) -> None:
    network, avatar, people = copy.deepcopy(scene)
    with torch.no_grad():
        network.layers[-1].bias += 0.3
        moved = network.weights(torch.zeros(1, DIMENSION), torch.zeros(1, 3))
    nothing_read = np.where(people.resting[:, None], 0, people.features).astype("f4")
    assert people.resting.any()

    def loss(price: float, resting: np.ndarray, beside: Crowd | None = None) -> float:
        monkeypatch.setattr(closing, "STILLNESS", price)
        torch.manual_seed(0)
        people_there = replace(people, features=nothing_read, resting=resting)
        return float(ClosedLoop(network, avatar, people_there, beside).loss().detach())

    dear = loss(7.0, people.resting) - loss(0.0, people.resting)
    assert dear == pytest.approx(7.0 * float(moved.square().mean()), rel=1e-3)
    nobody = np.zeros_like(people.resting)
    assert loss(7.0, nobody) == loss(0.0, nobody)
    beside = replace(people, features=nothing_read * 0)
    assert loss(7.0, nobody, beside) - loss(0.0, nobody, beside) == pytest.approx(dear, rel=1e-3)


def test_every_response_judges_in_its_turn(scene: tuple[RegressorNetwork, Person, Crowd]) -> None:
    network, avatar, people = scene
    strange = answering(np.zeros((len(NAMES), people.wanted.shape[1]), "f4"))
    doubted, other = replace(avatar, doubters=(strange,)), replace(avatar, response=strange)

    def loss(who: Person, step: int) -> float:
        torch.manual_seed(1)
        return float(ClosedLoop(network, who, people).loss(step).detach())

    assert loss(doubted, 0) == loss(avatar, 0)
    assert loss(doubted, 1) == loss(other, 0) != loss(avatar, 1)
    one, two, both = (ClosedLoop(network, who, people).mismatch() for who in (avatar, other, doubted))
    assert both == pytest.approx((one + two) / 2, rel=1e-5)


def test_responses_of_one_person_are_learned_each_for_itself(scene: tuple[RegressorNetwork, Person, Crowd]) -> None:
    person, _ = person_of(scene[1].seen, 5, 0, responses=3)
    again, _ = person_of(scene[1].seen, 5, 0, responses=1)
    zero = torch.zeros(1, len(NAMES)), torch.zeros(1, 3)
    answers = [response(*zero) for response in (person.response, *person.doubters)]
    assert len(answers) == 3
    assert torch.equal(answers[0], again.response(*zero))
    assert not torch.allclose(answers[0], answers[1])
    assert not torch.allclose(answers[1], answers[2])
