"""The graph that ships: what the trained networks answer, and nothing that a runtime might not have."""

from dataclasses import replace

import numpy as np
import onnx
import onnxruntime
import pytest
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.regressor import Regressor

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.controls import (  # noqa: E402
    controls_of,
)
from gemheads.models.train.regressors.export_onnx import export_onnx  # noqa: E402
from gemheads.models.train.regressors.leaks import turned  # noqa: E402
from gemheads.models.train.regressors.network import FACING, TURN_LIMIT  # noqa: E402
from gemheads.models.train.regressors.response import TYPICAL  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import network_of, relative_features  # noqa: E402


@pytest.mark.parametrize("rigged", [True, False])
def test_the_exported_graph_is_the_network(rigged: bool) -> None:
    network = network_of(controls_of(toy_gem(rigged)))
    features, rotations = relative_features(20, 1) * 5, np.random.default_rng(1).normal(size=(20, 3)).astype("f4")
    regressor = Regressor(export_onnx([network]), toy_gem().coefficient_count)
    with torch.no_grad():
        wanted = network(torch.from_numpy(features), torch.from_numpy(rotations)).numpy()
    got = np.stack([regressor(f, r).coefficients for f, r in zip(features, rotations, strict=True)])
    np.testing.assert_allclose(got, wanted, atol=5e-4)
    assert np.ptp(got, axis=0).max() > 0.1


def test_a_small_turn_counts_as_much_as_a_large_one_and_none_is_a_huge_number() -> None:
    """Whether a head faces the camera decides whether what is read may be pose leak."""
    network = network_of(controls_of(toy_gem()))
    yaws = torch.tensor([0.0, FACING, 0.4, 40.0])
    turn = network.turn(torch.stack([0 * yaws, yaws, 0 * yaws], 1))
    assert not turn[0].any()
    facing, wide = turn[:, :3], turn[:, 3:]
    np.testing.assert_allclose(facing[:, 1], [0, 1, 1, 1], rtol=1e-6)
    rotations = torch.tensor([[0.0, FACING, 0.0], [0.1, 0.4, -0.2]])
    np.testing.assert_allclose(network.turn(rotations)[:, 3:] * TYPICAL, turned(rotations.numpy()), rtol=1e-5)
    assert wide.abs().max() == TURN_LIMIT


def test_a_committee_answers_the_mean_of_its_members_weights() -> None:
    controls = controls_of(toy_gem())
    members = [network_of(controls), network_of(controls, trained=False)]
    members[1].projection *= 0.5
    features, rotations = relative_features(20, 1) * 5, np.random.default_rng(1).normal(size=(20, 3)).astype("f4")
    regressor = Regressor(export_onnx(members), toy_gem().coefficient_count)
    got = np.stack([regressor(f, r).coefficients for f, r in zip(features, rotations, strict=True)])
    with torch.no_grad():
        seen = torch.from_numpy(features), torch.from_numpy(rotations)
        weights = torch.stack([member.weights(*seen) for member in members]).mean(0)
    wanted = controls.coefficients(weights.numpy())
    np.testing.assert_allclose(got, wanted, atol=5e-4)
    alone = Regressor(export_onnx(members[:1]), toy_gem().coefficient_count)
    assert (
        max(np.abs(g - alone(f, r).coefficients).max() for g, f, r in zip(got, features, rotations, strict=True)) > 0.1
    )


def test_what_members_have_in_common_is_worked_out_once() -> None:
    """A guard counts a graph's nodes, and each costs a frame its time."""
    controls = controls_of(toy_gem())
    members = [network_of(controls, trained=trained) for trained in (True, False)]
    both, one = (onnx.load_from_string(export_onnx(some)).graph.node for some in (members, members[:1]))
    assert [node.op_type for node in both].count("Slice") == [node.op_type for node in one].count("Slice") == 1
    steps = [(node.op_type, *node.input, *(item.i for item in node.attribute)) for node in both]
    assert len(set(steps)) == len(steps)


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
    assert (np.abs(answer.coefficients) <= 3 * gem.sigma * (1 + 1e-5)).all()


def test_a_graph_holds_only_operators_that_a_runtime_of_any_age_has() -> None:
    session = onnxruntime.InferenceSession(export_onnx([network_of(controls_of(toy_gem()))]))
    assert [i.name for i in session.get_inputs()] == ["relative_features", "head_rotation"]
    assert session.get_outputs()[0].shape == [1, 20]
