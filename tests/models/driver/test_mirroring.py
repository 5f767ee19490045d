"""Left and right of a face, swapped."""

import numpy as np
import pytest
from gemheads.models.driver import points
from gemheads.models.driver.geometry import read_geometry
from gemheads.models.driver.mirroring import mirrored_landmarks, mirrored_scores, opposite_landmarks
from gemheads.models.driver.networks import FOLDER, GEOMETRY_FILE, read_checked
from numpy.typing import NDArray


@pytest.fixture(scope="module")
def opposite() -> NDArray[np.intp]:
    return opposite_landmarks(read_geometry(read_checked(FOLDER, GEOMETRY_FILE)))


def test_every_landmark_is_opposite_of_its_opposite(opposite: NDArray[np.intp]) -> None:
    np.testing.assert_array_equal(opposite[opposite], np.arange(478))


def test_eyes_and_brows_are_opposite_of_each_other(opposite: NDArray[np.intp]) -> None:
    for right, left in ((points.RIGHT_EYE, points.LEFT_EYE), (points.RIGHT_BROW, points.LEFT_BROW)):
        assert opposite[list(right)].tolist() == list(left)


def test_what_lies_in_the_middle_stays_there(opposite: NDArray[np.intp]) -> None:
    forehead, tip, lip, chin = 10, 1, 13, 152
    assert opposite[[forehead, tip, lip, chin]].tolist() == [forehead, tip, lip, chin]


def test_irises_point_for_point(opposite: NDArray[np.intp]) -> None:
    assert opposite[468:].tolist() == [473, 476, 475, 474, 477, 468, 471, 470, 469, 472]


def test_landmarks_go_to_the_other_end_of_the_picture_twice_and_are_back(opposite: NDArray[np.intp]) -> None:
    landmarks = np.random.default_rng(0).uniform(0, 256, (478, 3))
    there = mirrored_landmarks(landmarks, opposite, 256)
    np.testing.assert_array_equal(there[points.LEFT_IRIS], landmarks[points.RIGHT_IRIS] * [-1, 1, 1] + [256, 0, 0])
    np.testing.assert_allclose(mirrored_landmarks(there, opposite, 256), landmarks)


def test_scores_of_sides_are_swapped_and_others_stay() -> None:
    scores = np.arange(52, dtype=np.float32)
    swapped = dict(zip(points.SCORES, mirrored_scores(scores), strict=True))
    assert swapped["eyeBlinkLeft"] == points.SCORES.index("eyeBlinkRight")
    assert swapped["mouthLeft"] == points.SCORES.index("mouthRight")
    assert swapped["jawOpen"] == points.SCORES.index("jawOpen")
    np.testing.assert_array_equal(mirrored_scores(mirrored_scores(scores)), scores)
