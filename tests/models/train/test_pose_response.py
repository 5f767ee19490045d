"""What an expression adds to the turn that is read is taken off."""

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.driver.axes import drawn_turn  # noqa: E402
from gemheads.models.driver.features import DIMENSION  # noqa: E402
from gemheads.models.driver.regressor import Regressor  # noqa: E402
from gemheads.models.train.controls import controls_of  # noqa: E402
from gemheads.models.train.export_onnx import export_onnx  # noqa: E402
from gemheads.models.train.pose_response import FARTHEST, MOST, PoseResponse, fit_pose_response  # noqa: E402
from gemheads.models.train.response import Responses  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import network_of, relative_features  # noqa: E402

CONTROLS = 5
NOD, GAIN = np.radians(4.0), 0.85
"""The first control lifts the head that is read, and so much of a nod is read, whatever the face does."""


def pictures(count: int, seed: int, lost: float = 0.0) -> Responses:
    """Of an avatar that is misread in these two ways; ``lost``: so many are read as another face."""
    rng = np.random.default_rng(seed)
    weights, drawn = rng.uniform(0, 1, (count, CONTROLS)), rng.normal(0, [0.15, 0.2, 0.1], (count, 3))
    seen = drawn + np.stack([NOD * weights[:, 0] + (GAIN - 1) * drawn[:, 0], 0 * drawn[:, 0], 0 * drawn[:, 0]], 1)
    seen[rng.random(count) < lost] += 1.0
    return Responses(*(array.astype("f4") for array in (weights, drawn, seen)), np.zeros((count, DIMENSION), "f4"))


def test_an_expression_adds_nothing_to_what_is_read_once_it_is_taken_off() -> None:
    pose = fit_pose_response(pictures(2000, 0, lost=0.02), 600, 0)
    held = pictures(500, 1)
    turn = pose.turn(torch.from_numpy(held.weights), torch.from_numpy(held.seen_rotations)).numpy()
    at_rest = held.rotations * [GAIN, 1, 1]
    before, after = (np.degrees(np.abs(one - at_rest)).mean(0) for one in (held.seen_rotations, turn))
    assert before[0] > 1.5
    assert after.max() < 0.2


def test_a_face_at_rest_turns_as_its_driver() -> None:
    pose = fit_pose_response(pictures(500, 0), 50, 0)
    rotations = torch.tensor([[0.0, 0.0, 0.0], [0.2, -0.4, 0.1]])
    torch.testing.assert_close(pose.turn(torch.zeros(2, CONTROLS), rotations), rotations)


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
        regressor = Regressor(export_onnx([network], poses[:count]), gem.coefficient_count)
        got = np.stack([regressor(f, r).turn for f, r in zip(features, rotations, strict=True)])
        wanted = np.mean(each[:count], axis=0)
        np.testing.assert_allclose(got, [drawn_turn(turn) for turn in wanted], atol=1e-4)
        assert np.abs(wanted - rotations).max() > 0.05
