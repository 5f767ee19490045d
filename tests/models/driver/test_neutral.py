"""The neutral is the frame at rest, and the reason says so."""

from dataclasses import replace

import numpy as np
import pytest
from gemheads.models.driver.face import FaceObservation, FaceTracker
from gemheads.models.driver.features import BLOCKS, feature_vector, score
from gemheads.models.driver.measures import MEASURES
from gemheads.models.driver.neutral import CANDIDATES, choose_neutral, neutral_of, other_neutrals
from gemheads.models.driver.points import SCORES
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec
from numpy.typing import NDArray


def turned(face: FaceObservation, yaw_deg: float, pitch_deg: float = 0.0) -> FaceObservation:
    pose = face.head_pose.copy()
    pose[:3, :3] = matrix_from_wxyz(wxyz_from_rotvec(np.radians([pitch_deg, yaw_deg, 0])))
    return replace(face, head_pose=pose)


def scoring(face: FaceObservation, name: str, value: float) -> FaceObservation:
    scores = face.scores.copy()
    scores[SCORES.index(name)] = value
    return replace(face, scores=scores)


def open_mouthed(face: FaceObservation, cm: float = 1.5) -> FaceObservation:
    mesh = face.metric_mesh.copy()
    mesh[[14, 17], 1] -= cm
    return replace(face, metric_mesh=mesh)


def lip_gap(features: NDArray[np.float32]) -> float:
    return float(features[BLOCKS["measures"]][MEASURES.index("lip_gap")])


def blinking(face: FaceObservation) -> FaceObservation:
    mesh = face.metric_mesh.copy()
    mesh[[159, 158, 160, 386, 385, 387]] = mesh[[145, 153, 144, 374, 380, 373]]
    return replace(face, metric_mesh=mesh)


def looking_aside(face: FaceObservation) -> FaceObservation:
    return replace(face, metric_irises=face.metric_irises + np.array([0.35, 0, 0]))  # 17 degrees


SPOILED = {
    "turned": lambda face: turned(face, 25),
    "expression": lambda face: scoring(face, "mouthSmileLeft", 0.9),
    "open_mouth": open_mouthed,
    "closed_eyes": blinking,
    "looking_aside": looking_aside,
    "blurred": lambda face: replace(face, sharpness=0.002),
}


@pytest.mark.parametrize("flaw", SPOILED)
def test_a_frame_with_a_flaw_is_passed_over(still_face: FaceObservation, flaw: str) -> None:
    observations = [SPOILED[flaw](still_face)] * 3 + [None] + [still_face] * 7 + [SPOILED[flaw](still_face)] * 2
    choice = choose_neutral(observations, [i / 30 for i in range(len(observations))])
    assert 4 <= choice.index <= 10
    assert choice.candidates[0].index == choice.index
    assert "at rest" in choice.reason
    assert f"frame {choice.index}" in choice.reason
    np.testing.assert_allclose(choice.features, feature_vector(still_face), atol=1e-6)
    worst = choose_neutral([SPOILED[flaw](still_face), *observations[4:11]], [0.0] + [i / 30 for i in range(1, 8)])
    assert worst.index != 0


def test_when_all_frames_are_turned_the_reason_says_it(still_face: FaceObservation) -> None:
    choice = choose_neutral([turned(still_face, yaw) for yaw in (40, 28, 33)], [0.0, 1.0, 2.0])
    assert choice.index == 1
    assert "the head is turned" in choice.reason


def test_the_reason_names_the_frame_of_the_clip(still_face: FaceObservation) -> None:
    faces, times = [turned(still_face, 30), still_face], [0.0, 1.4]
    assert choose_neutral(faces, times, [0, 35]).reason.startswith("frame 35 at 1.40 s")
    assert choose_neutral(faces, times, [None, None]).reason.startswith("the frame at 1.40 s")
    assert choose_neutral(faces, times, [0, 35]).index == 1


def test_who_is_filmed_from_below_is_at_rest_as_they_sit(still_face: FaceObservation) -> None:
    seen = [turned(still_face, 0, 0)] * 2 + [turned(still_face, 0, -20)] * 8
    choice = choose_neutral(seen, [i / 5 for i in range(10)])
    assert choice.index >= 2
    assert np.degrees(choice.rotation) == pytest.approx([-20, 0, 0], abs=0.1)
    assert "at rest" in choice.reason


def test_a_face_that_rests_only_where_it_is_bowed_is_not_bowed_throughout(still_face: FaceObservation) -> None:
    seen = [open_mouthed(still_face)] * 8 + [turned(still_face, 0, 20)]
    choice = choose_neutral(seen, [i / 5 for i in range(9)])
    assert choice.index == 8
    assert np.degrees(choice.rotation) == pytest.approx([5, 0, 0], abs=0.5)
    assert "nodded +20, tilted +0 degrees (counted as turned" in choice.reason


def test_who_speaks_to_somebody_beside_the_camera_faces_them_and_not_it(still_face: FaceObservation) -> None:
    seen = [turned(still_face, 40)] * 8 + [still_face]
    choice = choose_neutral(seen, [i / 5 for i in range(9)])
    assert choice.index == 8
    assert abs(np.degrees(choice.rotation[1])) < 10


def test_a_candidate_says_what_is_wrong_with_it(still_face: FaceObservation) -> None:
    best, worst = choose_neutral([turned(still_face, 30), still_face], [0.0, 1.4]).candidates
    assert best.flaws == ()
    assert worst.flaws == ("the head is turned",)
    assert worst.weakness == "the head is turned"


def test_the_neutral_is_a_median_of_calm_neighbours(still_face: FaceObservation) -> None:
    rng = np.random.default_rng(0)
    noisy = [replace(still_face, metric_mesh=still_face.metric_mesh + rng.normal(0, 0.02, (468, 3))) for _ in range(9)]
    choice = choose_neutral(noisy, [i / 30 for i in range(9)])
    clean = feature_vector(still_face)
    alone = np.mean([np.abs(feature_vector(face) - clean).mean() for face in noisy])
    assert np.abs(choice.features - clean).mean() < 0.8 * alone


def test_a_mouth_that_is_ajar_at_rest_rests_as_closed_as_it_is_elsewhere(still_face: FaceObservation) -> None:
    ajar = [scoring(open_mouthed(still_face, 0.1), "jawOpen", 0.08)] * 9
    closed = scoring(looking_aside(still_face), "jawOpen", 0.02)
    choice = choose_neutral([*ajar, closed, closed], [i / 30 for i in range(11)])
    assert choice.index < 9
    assert score(choice.features, "jawOpen") == pytest.approx(0.02, abs=1e-6)
    assert lip_gap(choice.features) == pytest.approx(lip_gap(feature_vector(closed)), abs=1e-5)
    assert np.count_nonzero(choice.features != feature_vector(ajar[0])) == 2


def test_what_a_turned_head_seems_to_close_is_not_believed(still_face: FaceObservation) -> None:
    ajar, turned_away = scoring(still_face, "jawOpen", 0.08), turned(scoring(still_face, "jawOpen", 0.0), 40)
    choice = choose_neutral([ajar] * 5 + [turned_away] * 5, [i / 30 for i in range(10)])
    assert score(choice.features, "jawOpen") == pytest.approx(0.08, abs=1e-6)


def test_other_neutrals_are_other_plausible_moments(still_face: FaceObservation) -> None:
    faces = [scoring(still_face, "mouthSmileLeft", 0.05 + 0.001 * i) for i in range(12)]
    faces += [turned(still_face, 40)] * 12
    times = [i / 10 for i in range(len(faces))]
    chosen = choose_neutral(faces, times).index
    others = [other.index for other in other_neutrals(faces, times, 4)]
    assert len(others) == 4
    assert chosen not in others
    assert max(others) < 12  # never the turned head
    assert min(np.diff(sorted([chosen, *others]))) >= 2  # nor almost the same moment
    assert other_neutrals([still_face], [0.0], 4) == ()


def test_nobody_gives_no_neutral() -> None:
    with pytest.raises(ValueError, match="no face in any of 3 frames"):
        choose_neutral([None] * 3, [0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match="0 observations with 1 times"):
        choose_neutral([], [0.0])


def test_a_given_neutral_keeps_its_reason(still_face: FaceObservation) -> None:
    choice = neutral_of(still_face, 4, 0.2, "frame 4, as asked")
    assert (choice.index, choice.reason, choice.candidates) == (4, "frame 4, as asked", ())


def test_a_real_clip_has_six_candidates_at_most(tracker: FaceTracker, frames: list[NDArray[np.uint8]]) -> None:
    observations = [tracker.track(frame) for frame in frames]
    choice = choose_neutral(observations, [i / 24 for i in range(len(frames))])
    assert 1 <= len(choice.candidates) <= CANDIDATES
    assert list(choice.candidates) == sorted(choice.candidates, key=lambda candidate: candidate.cost)
