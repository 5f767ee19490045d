"""A head is drawn so that its turn is read as it shall be."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.axes import LEAN_DEG, MOST_LOST, YAW_LOST, drawn_turn
from gemheads.models.driver.features import relative_rotation, rotation_in_camera
from gemheads.models.gemfile import load_gem

AVATARS = Path(__file__).parents[3] / "assets" / "avatars"


def test_a_head_that_only_nods_only_nods() -> None:
    np.testing.assert_allclose(drawn_turn(np.array([0.3, 0, 0])), [0.3, 0, 0], atol=1e-15)
    np.testing.assert_array_equal(drawn_turn(np.zeros(3)), np.zeros(3))


def test_axes_lean_in_the_direction_in_which_turns_are_misread() -> None:
    lean = np.sin(np.radians(LEAN_DEG))
    aside, tilted = drawn_turn(np.array([0, 0.4, 0])), drawn_turn(np.array([0, 0, 0.2]))
    np.testing.assert_allclose(aside, [0, 0.4, -0.4 * lean], atol=1e-3)
    np.testing.assert_allclose(tilted, [0, 0.2 * lean, 0.2], atol=1e-3)


def test_who_looks_down_turns_further_and_never_much_further() -> None:
    flat, down, up, deep = (drawn_turn(np.array([pitch, 0.4, 0]))[1] for pitch in (0.0, 0.2, -0.2, 30.0))
    np.testing.assert_allclose(
        [down, up, deep], flat * np.array([1 + 0.2 * YAW_LOST, 1 - 0.2 * YAW_LOST, 1 + MOST_LOST])
    )


@pytest.mark.parametrize("name", ["jonah", "mara", "theo"])
def test_a_turn_is_read_as_it_shall_be(name: str) -> None:
    mirror = Mirror(load_gem(AVATARS / f"{name}.gem"), 384)
    rest = mirror.neutral()

    def read(turn: np.ndarray) -> np.ndarray:
        mirror.restart()
        reading = mirror.read(mirror.draw(mirror.gem.rest_coefficients, turn), 2)
        assert reading is not None
        return rotation_in_camera(reading.rotation, rest.rotation)

    shall = np.radians([[0, 25, 0], [0, -25, 0], [0, 0, 15], [0, 0, -15], [-8, 20, -8], [12, -15, 5]])
    plain = np.stack([read(turn) - turn for turn in shall])
    better = np.stack([read(drawn_turn(turn)) - turn for turn in shall])
    crossed = np.linalg.norm(plain[:4, [2, 2, 1, 1]].diagonal()), np.linalg.norm(better[:4, [2, 2, 1, 1]].diagonal())
    assert crossed[1] < 0.75 * crossed[0]  # roll of who looks aside, yaw of who tilts
    assert np.linalg.norm(better[:, 1:]) < np.linalg.norm(plain[:, 1:])


def test_a_head_shaken_before_a_camera_on_its_side_is_shaken() -> None:
    mirror = Mirror(load_gem(AVATARS / "mara.gem"), 384)
    read = []
    for quarters in (0, 1):
        rotations = []
        for turn in np.radians([[0, 0, 0], [0, 20, 0]]):
            mirror.restart()
            picture = np.ascontiguousarray(np.rot90(mirror.draw(mirror.gem.rest_coefficients, turn), quarters))
            reading = mirror.read(picture, 2)
            assert reading is not None
            rotations.append(reading.rotation)
        read.append(np.degrees(relative_rotation(rotations[1], rotations[0])))
    np.testing.assert_allclose(read[1], read[0], atol=3)
    assert read[1][1] > 15
