"""An avatar acts what a network answers, its own or that of the avatar which it was before, to learn how that reads."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.regressor import Regressor, RegressorError
from gemheads.models.gemfile import load_gem, save_gem

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors import rehearsal, series, train_regressor  # noqa: E402
from gemheads.models.train.regressors.controls import Controls, controls_of  # noqa: E402
from gemheads.models.train.regressors.export_onnx import export_onnx  # noqa: E402
from gemheads.models.train.regressors.leaks import TERMS, Leaks  # noqa: E402
from gemheads.models.train.regressors.response import ITSELF, PORTRAIT, Responses, Sitting  # noqa: E402
from gemheads.models.train.regressors.strangers import Crowd  # noqa: E402
from linearperson import linear_person  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import network_of, relative_features  # noqa: E402

MARA = Path(__file__).parents[4] / "assets" / "avatars" / "mara.gem"


def test_a_rehearsal_draws_what_is_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    controls, rng = controls_of(toy_gem()), np.random.default_rng(0)
    network = network_of(controls)
    features, rotations = relative_features(400, 3), rng.normal(0, 0.2, (400, 3)).astype("f4")
    unknown = np.full((400, len(NAMES)), np.nan, "f4")
    audience = Crowd(features, rotations, np.zeros((400, 1), "f4"), np.zeros(400, np.bool_), rotations, unknown)
    drawn: list[Responses] = []
    sittings: list[Sitting] = []

    def drawing(gem, controls, weights, rng, progress, rotations, sitting):
        sittings.append(sitting)
        drawn.append(Responses(weights, rotations, rotations, features))
        return drawn[-1]

    monkeypatch.setattr(series, "measure_responses", drawing)
    answers = rehearsal.answers_of(network, audience)
    acted = rehearsal.rehearse(toy_gem(), controls, answers, audience, rng)
    assert (acted.weights >= 0).all()
    assert (acted.weights <= 1).all()
    assert 0.1 < (np.abs(acted.weights - answers).max(1) < 1e-6).mean() < 0.5
    assert np.abs(acted.weights - answers).max() < 0.4
    frontal = (acted.rotations == 0).all(1)
    assert 0.3 < frontal.mean() < 0.5
    np.testing.assert_array_equal(acted.rotations[~frontal], rotations[~frontal])
    rehearsal.rehearse(toy_gem(), controls, answers, audience, rng, sitting=PORTRAIT)
    assert sittings == [ITSELF, PORTRAIT]


def test_a_regressor_is_remembered_as_the_network_it_was() -> None:
    gem = load_gem(MARA)
    controls = controls_of(gem)
    network = network_of(controls)
    front, wanted, unknown = np.zeros((30, 3), "f4"), np.zeros((30, 1), "f4"), np.full((30, len(NAMES)), np.nan, "f4")
    audience = Crowd(relative_features(30, 3), front, wanted, np.zeros(30, np.bool_), front, unknown)
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

    def acting(gem, controls, answers, people, rng, progress, workers, sitting=ITSELF):
        assert (answers == 0.125).all() == (len(recalled) > len(acted))
        assert (sitting == PORTRAIT) == (len(acted) == train_regressor.REHEARSALS)
        acted.append(answers)
        return linear_person(shapes, leak, len(people), len(acted)).seen

    acted: list[np.ndarray] = []
    monkeypatch.setattr(train_regressor, "CROWD", 400)
    monkeypatch.setattr(train_regressor, "pictures_of", lambda *_: linear_person(shapes, leak, 200).seen)
    monkeypatch.setattr(train_regressor, "leaks_of_bystanders", lambda *_: Leaks(np.zeros((1, TERMS, DIMENSION), "f4")))
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
    assert report.pictures == 200 + train_regressor.REHEARSALS * 200, (
        "portraits are of another light, and teach turns alone"
    )


def test_what_teaches_the_networks_is_learned_as_long_as_they(
    recalled: list[Controls], monkeypatch: pytest.MonkeyPatch
) -> None:
    lasted: list[int] = []
    said: list[tuple[int, int]] = []
    fit = train_regressor.fit_response

    def fitting(inputs, channels, steps, seed):
        lasted.append(steps)
        return fit(inputs, channels, steps, seed)

    def progress(stage: str, done: int, total: int) -> None:
        if stage == "response":
            said.append((done, total))

    monkeypatch.setattr(train_regressor, "fit_response", fitting)
    monkeypatch.setattr(train_regressor, "REHEARSALS", 1)
    none = np.empty((0, DIMENSION + 3), "f4")
    train_regressor.regressor_for(toy_gem(), [], none, pictures=200, steps=9, seed=0, progress=progress)
    assert lasted == [3] * train_regressor.RESPONSES + [9] * train_regressor.RESPONSES
    assert said[-1] == (train_regressor.RESPONSES, train_regressor.RESPONSES)


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
