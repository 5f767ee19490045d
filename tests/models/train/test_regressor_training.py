"""The regressor's training, in parts and on a small scale; the real thing is measured by tests/bench/closed_loop.py."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import onnxruntime
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.driver.baseline import GAIN, baseline_weights
from gemheads.models.driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES, score
from gemheads.models.driver.regressor import Regressor, RegressorError
from gemheads.models.gemfile import load_gem, save_gem

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train import rehearsal, response, train_regressor  # noqa: E402
from gemheads.models.train.channels import channel_indices, channel_tolerances  # noqa: E402
from gemheads.models.train.controls import (  # noqa: E402
    DEEPEST,
    HARDLY_READ,
    HARDLY_READ_REACH,
    STRAIGHT,
    UNREAD,
    Controls,
    controls_of,
)
from gemheads.models.train.export_onnx import export_onnx  # noqa: E402
from gemheads.models.train.expressions import random_weights  # noqa: E402
from gemheads.models.train.network import RegressorNetwork  # noqa: E402
from gemheads.models.train.reduction import compared_channels, principal_components  # noqa: E402
from gemheads.models.train.response import Responses  # noqa: E402
from gemheads.models.train.strangers import Crowd  # noqa: E402
from gemheads.models.train.takeover import taken_over  # noqa: E402
from linearperson import linear_person  # noqa: E402
from toygem import toy_gem  # noqa: E402

MARA = Path(__file__).parents[3] / "assets" / "avatars" / "mara.gem"
GAZES = (("OutLeft", "InRight"), ("InLeft", "OutRight"), ("UpLeft", "UpRight"), ("DownLeft", "DownRight"))
"""Where both eyes look at one thing."""


def relative_features(count: int, seed: int = 0) -> np.ndarray:
    return (np.random.default_rng(seed).normal(size=(count, DIMENSION)) * 0.1).astype("f4")


def network_of(controls: Controls, trained: bool = True) -> RegressorNetwork:
    torch.manual_seed(0)
    network = RegressorNetwork(principal_components(relative_features(300)), controls)
    if trained:
        with torch.no_grad():
            for parameter in network.parameters():
                parameter.add_(0.2 * torch.randn_like(parameter))
            for learned in (*network.parameters(), network.projection):  # as a file keeps them
                learned.copy_(learned.half())
    return network


@pytest.mark.parametrize("rigged", [True, False])
def test_the_exported_graph_is_the_network(rigged: bool) -> None:
    network = network_of(controls_of(toy_gem(rigged)))
    features, rotations = relative_features(20, 1) * 5, np.random.default_rng(1).normal(size=(20, 3)).astype("f4")
    regressor = Regressor(export_onnx([network]), toy_gem().coefficient_count)
    with torch.no_grad():
        wanted = network(torch.from_numpy(features), torch.from_numpy(rotations)).numpy()
    got = np.stack([regressor(f, r) for f, r in zip(features, rotations, strict=True)])
    np.testing.assert_allclose(got, wanted, atol=1e-4)
    assert np.ptp(got, axis=0).max() > 0.1


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


def test_a_committee_answers_the_mean_of_its_members_weights() -> None:
    controls = controls_of(toy_gem())
    members = [network_of(controls), network_of(controls, trained=False)]
    members[1].projection *= 0.5
    features, rotations = relative_features(20, 1) * 5, np.random.default_rng(1).normal(size=(20, 3)).astype("f4")
    regressor = Regressor(export_onnx(members), toy_gem().coefficient_count)
    got = np.stack([regressor(f, r) for f, r in zip(features, rotations, strict=True)])
    with torch.no_grad():
        seen = torch.from_numpy(features), torch.from_numpy(rotations)
        weights = torch.stack([member.weights(*seen) for member in members]).mean(0)
    wanted = controls.coefficients(weights.numpy())
    np.testing.assert_allclose(got, wanted, atol=1e-4)
    alone = Regressor(export_onnx(members[:1]), toy_gem().coefficient_count)
    assert max(np.abs(g - alone(f, r)).max() for g, f, r in zip(got, features, rotations, strict=True)) > 0.1


def test_networks_of_different_avatars_are_no_committee() -> None:
    controls = controls_of(toy_gem())
    with pytest.raises(ValueError, match="different avatars"):
        export_onnx([network_of(controls), network_of(replace(controls, rest=controls.rest + 1))])


def test_a_network_that_has_grown_beyond_float16_is_not_written() -> None:
    network = network_of(controls_of(toy_gem()))
    with torch.no_grad():
        next(network.parameters()).fill_(1e6)
    with pytest.raises(ValueError, match="float16"):
        export_onnx([network])


def test_the_same_weights_give_the_same_bytes() -> None:
    controls = controls_of(toy_gem())
    assert export_onnx([network_of(controls)]) == export_onnx([network_of(controls)])


def test_coefficients_stay_within_three_sigma_whatever_comes_in() -> None:
    gem = toy_gem()
    regressor = Regressor(export_onnx([network_of(controls_of(gem))]), gem.coefficient_count)
    answer = regressor(np.full(DIMENSION, 1e6, "f4"), np.array([9.0, -9.0, 9.0], "f4"))
    assert (np.abs(answer) <= 3 * gem.sigma * (1 + 1e-5)).all()


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


@pytest.mark.parametrize("avatar", sorted(MARA.parent.glob("*.gem")), ids=lambda path: path.stem)
def test_no_avatar_that_ships_squints(avatar: Path) -> None:
    gem = load_gem(avatar)
    assert gem.regressor is not None
    regressor = Regressor(gem.regressor, gem.coefficient_count)
    answers = [regressor(features, np.zeros(3, "f4")) for features in relative_features(40, 4)]
    weights = controls_of(gem).weights(np.stack(answers))
    for one, other in GAZES:
        left, right = NAMES.index(f"eyeLook{one}"), NAMES.index(f"eyeLook{other}")
        np.testing.assert_allclose(weights[:, left], weights[:, right], atol=0.01)


def test_a_graph_holds_only_operators_that_a_runtime_of_any_age_has() -> None:
    session = onnxruntime.InferenceSession(export_onnx([network_of(controls_of(toy_gem()))]))
    assert [i.name for i in session.get_inputs()] == ["relative_features", "head_rotation"]
    assert session.get_outputs()[0].shape == [1, 20]


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


def test_principal_components_are_whitened_and_drop_what_is_only_rounding() -> None:
    rng = np.random.default_rng(0)
    flat = rng.normal(size=(400, 7)) @ rng.normal(size=(7, DIMENSION))
    reduction = principal_components(flat.astype("f4"))
    kappa = (flat - reduction.mean) @ reduction.projection
    assert kappa.shape[1] == 7
    np.testing.assert_allclose(np.cov(kappa.T), np.eye(7), atol=1e-3)


def test_principal_components_of_features_of_which_some_never_differ() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(60, DIMENSION)).astype("f4")
    features[:, BLOCKS["gaze"]] = 0
    reduction = principal_components(features)
    assert np.isfinite(reduction.projection).all()
    assert not reduction.projection[BLOCKS["gaze"]].any()
    for alike in (features[:1], np.repeat(features[:1], 5, 0)):
        with pytest.raises(ValueError, match="do not differ"):
            principal_components(alike)


def test_compared_channels_are_all_that_a_network_of_the_closed_loop_sees() -> None:
    rng = np.random.default_rng(0)
    features = (rng.normal(size=(400, DIMENSION)) * rng.uniform(0.05, 0.5, DIMENSION)).astype("f4")
    places = channel_indices()
    features[:, places[3]] = 0.2
    reduction = compared_channels(features)
    kappa = (features - reduction.mean) @ reduction.projection
    differ = np.arange(len(places)) != 3
    np.testing.assert_allclose(kappa.std(0)[differ], 1, atol=1e-3)
    np.testing.assert_allclose(kappa[:, 3], 0, atol=1e-3)
    others = np.setdiff1d(np.arange(DIMENSION), places)
    features[:, others] += rng.normal(size=(400, len(others)))
    np.testing.assert_allclose((features - reduction.mean) @ reduction.projection, kappa, atol=1e-5)


def test_a_rehearsal_draws_what_is_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    controls, rng = controls_of(toy_gem()), np.random.default_rng(0)
    network = network_of(controls)
    features, rotations = relative_features(400, 3), rng.normal(0, 0.2, (400, 3)).astype("f4")
    audience = Crowd(features, rotations, np.zeros((400, 1), "f4"), np.zeros(400, np.bool_))
    drawn: list[Responses] = []

    def drawing(gem, controls, weights, rng, progress, rotations):
        drawn.append(Responses(weights, rotations, features))
        return drawn[-1]

    monkeypatch.setattr(rehearsal, "measure_responses", drawing)
    answers = rehearsal.answers_of(network, audience)
    acted = rehearsal.rehearse(toy_gem(), controls, answers, audience, rng)
    assert (acted.weights >= 0).all()
    assert (acted.weights <= 1).all()
    assert 0.1 < (np.abs(acted.weights - answers).max(1) < 1e-6).mean() < 0.5
    assert np.abs(acted.weights - answers).max() < 0.4
    frontal = (acted.rotations == 0).all(1)
    assert 0.3 < frontal.mean() < 0.5
    np.testing.assert_array_equal(acted.rotations[~frontal], rotations[~frontal])


def test_the_weights_of_coefficients_are_found_again() -> None:
    controls = controls_of(load_gem(MARA))
    weights = random_weights(300, np.random.default_rng(0))
    np.testing.assert_allclose(controls.weights(controls.coefficients(weights)), weights, atol=2e-3)
    beyond = controls.weights(np.stack([controls.limit, -controls.limit]))
    assert np.isfinite(beyond).all()
    assert (beyond >= controls.lower).all()
    assert (beyond <= controls.upper).all()


@pytest.mark.parametrize("avatar", sorted(MARA.parent.glob("*.gem")), ids=lambda path: path.stem)
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


def test_a_regressor_is_remembered_as_the_network_it_was() -> None:
    gem = load_gem(MARA)
    controls = controls_of(gem)
    network = network_of(controls)
    audience = Crowd(relative_features(30, 3), np.zeros((30, 3), "f4"), np.zeros((30, 1), "f4"), np.zeros(30, np.bool_))
    regressor = Regressor(export_onnx([network]), gem.coefficient_count)
    found, given = (
        controls.coefficients(weights)
        for weights in (rehearsal.remembered(regressor, controls, audience), rehearsal.answers_of(network, audience))
    )
    assert np.abs(given - gem.rest_coefficients).max() > 0.1
    np.testing.assert_allclose(found / controls.limit, given / controls.limit, atol=5e-3)


@pytest.fixture
def recalled(monkeypatch: pytest.MonkeyPatch) -> list[Controls]:
    """Whose weights a training that draws nothing has recalled; what is recalled is an eighth of everything."""
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(0, 0.1, (rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    recalled: list[Controls] = []

    def recalling(regressor, controls, people):
        recalled.append(controls)
        return np.full((len(people), len(NAMES)), 0.125, "f4")

    def acting(gem, controls, answers, people, rng, progress):
        assert (answers == 0.125).all() == (len(recalled) > len(acted))
        acted.append(answers)
        return linear_person(shapes, leak, len(people), len(acted)).seen

    acted: list[np.ndarray] = []
    monkeypatch.setattr(train_regressor, "CROWD", 400)
    monkeypatch.setattr(train_regressor, "pictures_of", lambda *_: linear_person(shapes, leak, 200).seen)
    monkeypatch.setattr(train_regressor, "remembered", recalling)
    monkeypatch.setattr(train_regressor, "rehearse", acting)
    return recalled


@pytest.mark.parametrize("usable", [True, False])
def test_an_avatar_that_has_a_regressor_rehearses_with_it_first(usable: bool, recalled: list[Controls]) -> None:
    """One that cannot be used is why people train again: no error."""
    toy = toy_gem()
    gem = replace(toy, regressor=export_onnx([network_of(controls_of(toy))]) if usable else b"of another version")
    graph, report = train_regressor.regressor_for(
        gem, [], np.empty((0, DIMENSION + 3), "f4"), pictures=200, steps=8, seed=0
    )
    Regressor(graph, gem.coefficient_count)
    assert len(recalled) == (1 if usable else 0)
    assert report.pictures > 200


def test_an_avatar_baked_anew_rehearses_with_what_the_former_one_learned(
    recalled: list[Controls], tmp_path: Path
) -> None:
    baked, former = tmp_path / "baked.gem", tmp_path / "former.gem"
    anew, old = toy_gem(), toy_gem(components=4)
    save_gem(replace(anew, regressor=export_onnx([network_of(controls_of(anew))])), baked)
    save_gem(replace(old, regressor=export_onnx([network_of(controls_of(old))])), former)
    gem, _ = train_regressor.train_regressor(baked, former=former, pictures=200, steps=8)
    assert gem.regressor is not None
    Regressor(gem.regressor, anew.coefficient_count)
    (controls,) = recalled
    assert len(controls.rest) == old.coefficient_count


@pytest.mark.parametrize(
    ("rigged", "graph", "said"),
    [
        (True, None, "'toy' has no regressor to rehearse with"),
        (True, b"no graph", "cannot be used"),
        (False, None, "only avatars with ARKit shapes"),
    ],
)
def test_a_former_of_no_use_is_an_error(rigged: bool, graph: bytes | None, said: str, tmp_path: Path) -> None:
    former = tmp_path / "former.gem"
    save_gem(replace(toy_gem(rigged), regressor=graph), former)
    with pytest.raises(RegressorError, match=said):
        train_regressor.train_regressor(MARA, former=former)


def test_an_avatar_that_takes_over_shows_the_same_arkit_weights() -> None:
    old, anew = toy_gem(), toy_gem(components=4)
    assert anew.arkit_weights is not None
    anew = replace(anew, arkit_weights=1.5 * anew.arkit_weights)
    members = [network_of(controls_of(old)), network_of(controls_of(old), trained=False)]
    regressor = Regressor(taken_over(replace(old, regressor=export_onnx(members)), anew), anew.coefficient_count)
    features, still = relative_features(10, 2) * 5, np.zeros((10, 3), np.float32)
    with torch.no_grad():
        answers = [member.weights(torch.from_numpy(features), torch.from_numpy(still)).numpy() for member in members]
    wanted = controls_of(anew).coefficients(np.mean(answers, 0))
    got = np.stack([regressor(one, np.zeros(3)) for one in features])
    np.testing.assert_allclose(got, wanted, atol=1e-3)
    assert np.ptp(got, axis=0).max() > 0.1


def foreign() -> bytes:
    """The graph of another avatar: what it calls its constants is not what this one's are."""
    gem = toy_gem()
    return export_onnx([network_of(controls_of(replace(gem, rest=gem.rest_coefficients + 1)))])


@pytest.mark.parametrize(
    ("rigged", "graph", "said"),
    [
        (True, lambda: None, "'toy' has no regressor to take over"),
        (True, lambda: b"no graph", "cannot be used"),
        (True, foreign, "is not one that train-regressor wrote"),
        (False, lambda: None, "only avatars with ARKit shapes"),
    ],
)
def test_what_cannot_be_taken_over_is_an_error(rigged: bool, graph: Callable[[], bytes | None], said: str) -> None:
    with pytest.raises(RegressorError, match=said):
        taken_over(replace(toy_gem(rigged), regressor=graph()), toy_gem())


def test_pictures_of_whole_series_are_the_first_of_more(monkeypatch: pytest.MonkeyPatch) -> None:
    def drawing(gem, controls, weights, rng, progress):
        return Responses(weights, rng.normal(size=(len(weights), 3)), relative_features(len(weights)))

    monkeypatch.setattr(train_regressor, "measure_responses", drawing)
    few, more = (train_regressor.pictures_of(toy_gem(), count, 3) for count in (train_regressor.SERIES, 1300))
    assert len(more) == 1300
    np.testing.assert_array_equal(few.weights, more.weights[: len(few)])
    np.testing.assert_array_equal(few.rotations, more.rotations[: len(few)])
    assert np.abs(more.weights[train_regressor.SERIES] - more.weights[1]).max() > 0


def test_some_pictures_show_a_face_at_rest_that_turns_further(monkeypatch: pytest.MonkeyPatch) -> None:
    class Studio:
        def __init__(self, gem: object) -> None:
            pass

        def read(self, coefficients, rotation, rng, still=False):
            return np.zeros(DIMENSION, "f4")

    monkeypatch.setattr(response, "_Studio", Studio)
    drawn = train_regressor.pictures_of(toy_gem(), 4000, 3)
    rest = ~drawn.weights.any(1)
    turned = drawn.rotations[drawn.rotations.any(1) & ~rest], drawn.rotations[rest]
    assert train_regressor.RESTING <= rest.mean() < train_regressor.RESTING + 0.05
    assert 1.15 < turned[1].std() / turned[0].std() < 1.45


def test_channels_and_tolerances_go_together() -> None:
    indices, tolerances = channel_indices(), channel_tolerances()
    assert len(indices) == len(tolerances) == len(set(indices))
    assert (tolerances > 0).all()
    jaw = SCORES.start + SCORE_NAMES.index("jawOpen")
    assert jaw in indices
    assert not set(indices) & set(range(BLOCKS["mixer"].start, BLOCKS["mixer"].stop))
