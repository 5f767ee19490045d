import numpy as np
import pytest
from gemheads.app.performing.portrait import portrait
from gemheads.models.gem import Viewing
from gemheads.render.camera import Camera

VIEWING = Viewing(target=(0.0, 0.02, 0.01), head_height=0.26)


def row_of(camera: Camera, y: float) -> float:
    point = camera.world_to_camera @ [VIEWING.target[0], y, VIEWING.target[2], 1]
    return float(camera.fy * point[1] / point[2] + camera.cy)


@pytest.mark.parametrize("size", [(512, 512), (1024, 1024), (640, 360), (1920, 1080), (802, 550)])
def test_the_head_fills_its_share_with_room_above_and_shoulders_below(size: tuple[int, int]) -> None:
    camera = portrait(VIEWING, *size)
    crown, chin = row_of(camera, 0.02 + 0.13) / size[1], row_of(camera, 0.02 - 0.13) / size[1]
    assert 0.60 <= chin - crown <= 0.70
    assert 0.08 <= crown <= 0.2
    assert chin <= 0.8


@pytest.mark.parametrize(("size", "share", "most_above"), [((540, 960), 0.55, 0.25), ((600, 800), 0.62, 0.15)])
def test_a_tall_picture_is_filled_as_far_as_the_head_is_wide(
    size: tuple[int, int], share: float, most_above: float
) -> None:
    camera = portrait(VIEWING, *size)
    crown, chin = row_of(camera, 0.02 + 0.13) / size[1], row_of(camera, 0.02 - 0.13) / size[1]
    assert chin - crown >= share
    assert crown <= most_above


def test_a_narrow_picture_keeps_the_whole_width_of_the_head() -> None:
    camera = portrait(VIEWING, 300, 600)
    height_px = row_of(camera, 0.02 - 0.13) - row_of(camera, 0.02 + 0.13)
    assert 0.78 * height_px < 300  # heads are about three quarters as wide as high


@pytest.mark.parametrize("size", [(540, 960), (400, 900), (512, 512), (960, 540)])
def test_no_picture_shows_more_of_the_bust_than_a_square_does(size: tuple[int, int]) -> None:
    """Below .9 heights of the head the busts of the shipped avatars fray."""
    assert row_of(portrait(VIEWING, *size), 0.02 - 0.86 * 0.26) == pytest.approx(size[1], abs=1.5)


def test_yaw_turns_the_camera_about_the_head() -> None:
    centre = portrait(VIEWING, 512, 512, yaw_deg=30).center
    assert centre[0] > 0.1
    assert np.linalg.norm(centre - portrait(VIEWING, 512, 512).center) > 0.1


@pytest.mark.parametrize("pitch", [90.0, -90.0])
def test_from_right_above_a_side_is_still_up(pitch: float) -> None:
    """Files may allow so much."""
    assert np.isfinite(portrait(VIEWING, 64, 64, pitch_deg=pitch).world_to_camera).all()
