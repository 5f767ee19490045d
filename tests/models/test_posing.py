"""The head turns about the neck; the shoulders stay."""

import numpy as np
import pytest
from gemheads.models.posing import pose_head
from gemheads.render.gaussians import RawGaussians
from gemheads.render.rotations import matrix_from_wxyz, normalized, wxyz_from_rotvec

PIVOT = np.float32([0.01, -0.1, -0.02])
TURN, MOVE = np.array([0.2, -0.5, 0.1]), np.array([0.01, 0.02, -0.03])


@pytest.fixture
def raw() -> RawGaussians:
    rng = np.random.default_rng(1)
    return RawGaussians(
        positions=rng.normal(0, 0.1, (30, 3)).astype(np.float32),
        wxyz=rng.normal(size=(30, 4)).astype(np.float32),
        log_scales=rng.normal(-6, 0.3, (30, 3)).astype(np.float32),
        opacity_logits=rng.normal(size=30).astype(np.float32),
        colors=rng.random((30, 3), np.float32),
    )


def test_a_whole_share_is_the_rigid_motion(raw: RawGaussians) -> None:
    posed = pose_head(raw, np.ones(30, np.float32), PIVOT, TURN, MOVE)
    rotation = matrix_from_wxyz(wxyz_from_rotvec(TURN))
    np.testing.assert_allclose(posed.positions, (raw.positions - PIVOT) @ rotation.T + PIVOT + MOVE, atol=1e-6)
    wanted = rotation @ matrix_from_wxyz(raw.wxyz)
    np.testing.assert_allclose(matrix_from_wxyz(posed.wxyz), wanted, atol=1e-5)
    assert posed.log_scales is raw.log_scales
    assert posed.opacity_logits is raw.opacity_logits


def test_a_share_turns_by_its_part_of_the_angle(raw: RawGaussians) -> None:
    shares = np.linspace(0, 1, 30, dtype=np.float32)
    posed = pose_head(raw, shares, PIVOT, TURN, MOVE)
    for i in (0, 7, 19):
        alone = pose_head(raw, np.ones(30, np.float32), PIVOT, shares[i] * TURN, shares[i] * MOVE)
        np.testing.assert_allclose(posed.positions[i], alone.positions[i], atol=1e-6)
        np.testing.assert_allclose(normalized(posed.wxyz)[i], normalized(alone.wxyz)[i], atol=1e-6)


def test_the_shoulders_stay(raw: RawGaussians) -> None:
    posed = pose_head(raw, np.zeros(30, np.float32), PIVOT, TURN, MOVE)
    np.testing.assert_allclose(posed.positions, raw.positions, atol=1e-7)
    np.testing.assert_array_equal(posed.wxyz, raw.wxyz)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-6, np.pi, 7.0])
def test_any_angle_keeps_distances(raw: RawGaussians, angle: float) -> None:
    posed = pose_head(raw, np.ones(30, np.float32), PIVOT, np.array([0, angle, 0]), np.zeros(3))
    before = np.linalg.norm(raw.positions - PIVOT, axis=1)
    np.testing.assert_allclose(np.linalg.norm(posed.positions - PIVOT, axis=1), before, rtol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(posed.wxyz, axis=1), np.linalg.norm(raw.wxyz, axis=1), rtol=1e-5)


def test_it_overwrites_what_it_is_given_and_not_its_source(raw: RawGaussians) -> None:
    before = raw.positions.copy(), raw.wxyz.copy()
    shares = np.ones(30, np.float32)
    out = pose_head(raw, shares, PIVOT, TURN, MOVE)
    wanted = out.positions.copy()
    assert pose_head(raw, shares, PIVOT, -TURN, MOVE, out) is out
    assert not np.allclose(out.positions, wanted)
    np.testing.assert_array_equal(raw.positions, before[0])
    np.testing.assert_array_equal(raw.wxyz, before[1])


@pytest.mark.parametrize(
    ("turn", "move"),
    [([np.nan, 0, 0], [0, 0, 0]), ([0, 0, 0], [0, np.inf, 0]), ([0, 0], [0, 0, 0]), (np.eye(3), [0, 0, 0])],
)
def test_a_pose_that_is_none_is_refused(raw: RawGaussians, turn: list, move: list) -> None:
    with pytest.raises(ValueError, match="three finite angles"):
        pose_head(raw, np.ones(30, np.float32), PIVOT, np.array(turn), np.array(move))
