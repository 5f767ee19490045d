"""What an avatar adds to the turn that is read is taken off."""

import numpy as np
import onnx
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.driver.axes import drawn_turn  # noqa: E402
from gemheads.models.driver.features import DIMENSION  # noqa: E402
from gemheads.models.driver.regressor import Regressor, RegressorError  # noqa: E402
from gemheads.models.train.regressors import turns  # noqa: E402
from gemheads.models.train.regressors.controls import controls_of  # noqa: E402
from gemheads.models.train.regressors.export_onnx import export_onnx  # noqa: E402
from gemheads.models.train.regressors.export_turns import with_turns  # noqa: E402
from gemheads.models.train.regressors.pose_response import FARTHEST, MOST, PoseResponse, fit_pose_response  # noqa: E402
from gemheads.models.train.regressors.response import Responses  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import network_of, relative_features  # noqa: E402

CONTROLS = 5
NOD, GAIN, WIDER = np.radians(4.0), 0.85, 1.1
"""The first control lifts the head that is read, and so much of a nod, and of a turn aside, is read, whatever the face
does."""


def pictures(count: int, seed: int, lost: float = 0.0) -> Responses:
    """Of an avatar that is misread in these two ways; ``lost``: so many are read as another face."""
    rng = np.random.default_rng(seed)
    weights, drawn = rng.uniform(0, 1, (count, CONTROLS)), rng.normal(0, [0.15, 0.2, 0.1], (count, 3))
    seen = drawn * [GAIN, WIDER, 1] + np.outer(weights[:, 0], [NOD, 0, 0])
    seen[rng.random(count) < lost] += 1.0
    return Responses(*(array.astype("f4") for array in (weights, drawn, seen)), np.zeros((count, DIMENSION), "f4"))


def test_an_expression_adds_nothing_to_what_is_read_once_it_is_taken_off() -> None:
    pose = fit_pose_response(pictures(2000, 0, lost=0.02), 600, 0)
    held = pictures(500, 1)
    turn = pose.turn(torch.from_numpy(held.weights), torch.from_numpy(held.seen_rotations)).numpy()
    at_rest = held.rotations * [GAIN, 1, 1]
    before, after = (np.degrees(np.abs(one - at_rest)).mean(0) for one in (held.seen_rotations, turn))
    assert (before[:2] > 0.8).all()
    assert after.max() < 0.2


def test_a_face_at_rest_nods_as_its_driver_and_stays_where_it_is_when_nothing_is_asked() -> None:
    pose = fit_pose_response(pictures(2000, 0), 600, 0)
    rotations = torch.tensor([[0.0, 0.0, 0.0], [0.2, -0.33, 0.1]])
    turn = pose.turn(torch.zeros(2, CONTROLS), rotations)
    torch.testing.assert_close(turn[0], rotations[0])
    torch.testing.assert_close(turn[:, 0], rotations[:, 0])
    assert turn[1, 1] == pytest.approx(-0.33 / WIDER, abs=0.01)
    assert turn[1, 2] == pytest.approx(0.1, abs=0.01)


def test_far_turns_add_what_the_farthest_do_and_nothing_adds_much() -> None:
    pose = fit_pose_response(pictures(500, 0), 50, 0)
    weights, farthest = torch.full((1, CONTROLS), 0.5), torch.tensor(FARTHEST[None], dtype=torch.float32)
    torch.testing.assert_close(pose(weights, 5 * farthest), pose(weights, farthest))
    assert pose(1e6 * weights, farthest).abs().max() == pytest.approx(MOST)


def test_pictures_that_are_all_misread_teach_nothing_and_break_nothing() -> None:
    pose = fit_pose_response(pictures(50, 0, lost=1.0), 10, 0)
    assert all(torch.isfinite(parameter).all() for parameter in pose.parameters())


def test_the_exported_graph_turns_as_the_models_do_in_the_mean() -> None:
    gem = toy_gem()
    network, poses = network_of(controls_of(gem)), [PoseResponse(52) for _ in range(2)]
    with torch.no_grad():
        for parameter in (parameter for pose in poses for parameter in pose.parameters()):
            parameter.copy_((3 * parameter + 0.3 * torch.randn_like(parameter)).half())
    features, rotations = relative_features(20, 1) * 5, np.random.default_rng(1).normal(0, 0.3, (20, 3)).astype("f4")
    seen = torch.from_numpy(features), torch.from_numpy(rotations)
    with torch.no_grad():
        each = [pose.turn(network.weights(*seen), seen[1]).numpy() for pose in poses]
    for count in (1, 2):
        regressor = Regressor(with_turns(export_onnx([network]), poses[:count]), gem.coefficient_count)
        got = np.stack([regressor(f, r).turn for f, r in zip(features, rotations, strict=True)])
        wanted = np.mean(each[:count], axis=0)
        np.testing.assert_allclose(got, [drawn_turn(turn) for turn in wanted], atol=1e-4)
        assert np.abs(wanted - rotations).max() > 0.05


def test_turns_that_are_learned_anew_take_the_place_of_the_former_ones() -> None:
    network = network_of(controls_of(toy_gem()))
    first, second = [PoseResponse(52)], [PoseResponse(52), PoseResponse(52)]
    plain = export_onnx([network])
    assert with_turns(with_turns(plain, first), second) == with_turns(plain, second) != with_turns(plain, first)


def test_a_regressor_that_training_did_not_write_learns_no_turns() -> None:
    model = onnx.load_from_string(export_onnx([network_of(controls_of(toy_gem()))]))
    for node in model.graph.node:
        node.input[:] = [name.replace("to_coefficients", "elsewhere") for name in node.input]
    with pytest.raises(RegressorError, match="not one that train-regressor wrote"):
        with_turns(model.SerializeToString(), [PoseResponse(52)])


def test_what_is_known_of_turns_is_told_of_portraits_that_were_held_back() -> None:
    known = turns.learned_turns(pictures(1000, 0, lost=0.02), 300, 0)
    assert known.portraits == 900
    assert len(known.poses) == turns.POSES
    assert 2 < known.missed_deg[0] < 3
    assert 0 < known.left_deg[0] < 0.3
    assert np.isfinite(turns.learned_turns(pictures(50, 0, lost=1.0), 5, 0).left_deg).all()
