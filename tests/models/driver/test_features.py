"""Features, measures and gaze, on a face whose movements are known."""

from dataclasses import replace

import numpy as np
import pytest
from gemheads.models import arkit
from gemheads.models.driver.baseline import GAIN, baseline_weights
from gemheads.models.driver.face import FaceObservation
from gemheads.models.driver.features import (
    BLOCKS,
    DIMENSION,
    SCORE_NAMES,
    SCORES,
    feature_vector,
    head_rotation,
    relative_rotation,
    rotation_in_camera,
    score,
)
from gemheads.models.driver.gaze import EYEBALL_RADIUS_CM, eye_gaze, joined
from gemheads.models.driver.measures import MEASURES, measure
from gemheads.models.driver.points import RIGHT_BROW
from gemheads.models.driver.points import SCORES as NETWORK_SCORES
from gemheads.render.rotations import matrix_from_wxyz, rotvec_from_matrix, wxyz_from_rotvec


def test_blocks_fill_the_vector_without_gap_or_overlap(still_face: FaceObservation) -> None:
    covered = np.zeros(DIMENSION, int)
    for block in BLOCKS.values():
        covered[block] += 1
    assert (covered == 1).all()
    features = feature_vector(still_face)
    assert features.shape == (DIMENSION,)
    assert features.dtype == np.float32
    assert np.isfinite(features).all()


def test_a_score_is_found_by_its_name(still_face: FaceObservation) -> None:
    scores = still_face.scores.copy()
    scores[NETWORK_SCORES.index("mouthPucker")] = 0.75
    features = feature_vector(replace(still_face, scores=scores))
    assert score(features, "mouthPucker") == np.float32(0.75)
    assert score(np.stack([features] * 3), "mouthPucker").shape == (3,)
    with pytest.raises(KeyError, match="cheekPuff"):
        score(features, "cheekPuff")


def test_lips_are_pressed_on_both_sides_by_the_mean_of_what_is_read_on_each(still_face: FaceObservation) -> None:
    at_rest = feature_vector(still_face)
    scores = still_face.scores.copy()
    for side, pressed in (("Left", 0.8), ("Right", 0.2)):
        scores[NETWORK_SCORES.index(f"mouthPress{side}")] = pressed
    one_sided = feature_vector(replace(still_face, scores=scores))
    for side in ("Left", "Right"):
        assert score(one_sided, f"mouthPress{side}") == pytest.approx(0.5, abs=1e-6), side
    others = [name for name in SCORE_NAMES if not name.startswith("mouthPress")]
    assert [float(score(one_sided, name)) for name in others] == [float(score(at_rest, name)) for name in others]


def test_a_raised_brow_shows_in_its_own_measures_only(still_face: FaceObservation) -> None:
    raised = still_face.metric_mesh.copy()
    raised[list(RIGHT_BROW), 1] += 0.5
    change = dict(zip(MEASURES, measure(raised) - measure(still_face.metric_mesh), strict=True))
    for name, value in change.items():
        expected = 0.5 if name in ("right_inner_brow", "right_middle_brow", "right_outer_brow") else 0.0
        if name == "brow_distance":
            assert 0 < value < 0.1  # one side higher: a little farther apart
        else:
            assert value == pytest.approx(expected, abs=1e-9), name


def test_measures_of_mouth_and_lids(still_face: FaceObservation) -> None:
    mesh = still_face.metric_mesh.copy()
    mesh[[14, 17, 152], 1] -= 1.0  # lower lip and chin drop by a centimetre
    mesh[291] += [0.4, 0.3, 0.0]  # left corner out and up
    change = dict(zip(MEASURES, measure(mesh) - measure(still_face.metric_mesh), strict=True))
    assert change["lip_gap"] == pytest.approx(1.0, abs=0.2)  # the lips are not one behind the other
    assert change["jaw_drop"] == pytest.approx(1.0)
    assert change["mouth_width"] == pytest.approx(0.4, abs=0.05)
    assert change["left_corner_height"] == pytest.approx(0.3)
    assert change["right_corner_height"] == 0
    assert change["left_lid_gap"] == 0


@pytest.mark.parametrize(("angle_deg", "axis"), [(20, 0), (-15, 1)])
def test_gaze_is_the_angle_of_the_eyeball(still_face: FaceObservation, angle_deg: float, axis: int) -> None:
    irises = still_face.metric_irises.copy()
    irises[:, axis] += EYEBALL_RADIUS_CM * np.sin(np.radians(angle_deg))
    moved, rest = (eye_gaze(still_face.metric_mesh, i) for i in (irises, still_face.metric_irises))
    assert np.degrees(joined(moved - rest)[axis]) == pytest.approx(angle_deg, abs=0.5)
    assert joined(moved - rest)[1 - axis] == pytest.approx(0, abs=1e-9)


def test_an_iris_far_out_of_its_eye_stays_finite(still_face: FaceObservation) -> None:
    assert np.isfinite(eye_gaze(still_face.metric_mesh, still_face.metric_irises + 9)).all()


def test_head_rotation_ignores_scale_and_says_the_turn(still_face: FaceObservation) -> None:
    turn = np.array([0.1, -0.4, 0.2])
    pose = still_face.head_pose.copy()
    pose[:3, :3] = 1.3 * matrix_from_wxyz(wxyz_from_rotvec(turn))
    rotation = head_rotation(replace(still_face, head_pose=pose))
    np.testing.assert_allclose(rotation, turn, atol=1e-12)
    np.testing.assert_allclose(relative_rotation(rotation, rotation), 0, atol=1e-12)
    np.testing.assert_allclose(relative_rotation(rotation, np.zeros(3)), turn, atol=1e-12)


def test_the_baseline_reads_scores_as_weights() -> None:
    relative = np.zeros((2, DIMENSION), np.float32)
    relative[0, SCORES.start + SCORE_NAMES.index("jawOpen")] = 0.4
    relative[1, SCORES.start + SCORE_NAMES.index("mouthSmileLeft")] = -0.3
    relative[1, SCORES.start + SCORE_NAMES.index("eyeBlinkLeft")] = 0.95
    weights = baseline_weights(relative)
    assert weights.shape == (2, 52)
    assert weights[0, arkit.NAMES.index("jawOpen")] == pytest.approx(0.4 * GAIN)
    assert weights[1, arkit.NAMES.index("eyeBlinkLeft")] == 1
    assert np.count_nonzero(weights) == 2


def test_rotations_are_those_of_the_renderer(still_face: FaceObservation) -> None:
    rng = np.random.default_rng(5)
    for turn in [*rng.normal(0, 0.6, (20, 3)), np.zeros(3), np.array([np.pi - 1e-3, 0, 0])]:
        other = rng.normal(0, 0.6, 3)
        one, two = (matrix_from_wxyz(wxyz_from_rotvec(v)) for v in (turn, other))
        pose = still_face.head_pose.copy()
        pose[:3, :3] = 0.7 * one
        found = head_rotation(replace(still_face, head_pose=pose))
        np.testing.assert_allclose(found, rotvec_from_matrix(one), atol=1e-9)
        np.testing.assert_allclose(relative_rotation(turn, other), rotvec_from_matrix(two.T @ one), atol=1e-9)
        np.testing.assert_allclose(rotation_in_camera(turn, other), rotvec_from_matrix(one @ two.T), atol=1e-9)


@pytest.mark.parametrize("camera_deg", [(0, 0, 0), (-20, 0, 0), (0, 25, 0), (0, 0, 90), (-15, 10, 30)])
def test_a_head_turns_about_its_own_axes_however_the_camera_stands(camera_deg: tuple[float, float, float]) -> None:
    turn, ahead = np.radians([4.0, 25.0, -6.0]), np.radians(camera_deg)
    stand, own = (matrix_from_wxyz(wxyz_from_rotvec(rotation)) for rotation in (ahead, turn))
    seen = rotvec_from_matrix(stand @ own)
    np.testing.assert_allclose(relative_rotation(seen, ahead), turn, atol=1e-9)


def test_a_pose_that_is_no_number_is_not_taken_for_a_head_at_rest(still_face: FaceObservation) -> None:
    pose = np.full((4, 4), np.nan)
    assert np.isnan(head_rotation(replace(still_face, head_pose=pose))).all()
    assert np.isnan(relative_rotation(np.full(3, np.nan), np.zeros(3))).all()
