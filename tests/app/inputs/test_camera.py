"""The camera with a device that is none: OpenCV's face, our faults."""

import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from devices import Device, blue
from gemheads.app.inputs import camera
from gemheads.app.inputs.camera import CURES, CameraChoice, cameras, open_camera
from gemheads.app.inputs.source import LiveSource, SourceLost, TimedFrame

CHOICE = CameraChoice("Cam", 0)


def opened(device: Device, connected: list[CameraChoice] | None = None, **more: object) -> LiveSource:
    found = [CHOICE] if connected is None else connected
    return open_camera(CHOICE, (64, 48), 30, lambda: found, lambda index: device, **more)()  # pyright: ignore[reportArgumentType]


def read_on(camera: LiveSource) -> TimedFrame:
    """Its first picture; or what it raises."""
    for _ in range(100):
        if (frame := camera.read(0.1)) is not None:
            return frame
    raise AssertionError("no picture, and no word about that")


def test_pictures_come_as_rgb_with_the_time_they_were_taken() -> None:
    device = Device(blue)
    camera = opened(device)
    try:
        frame = camera.read(5)
        assert isinstance(frame, TimedFrame)
        assert frame.rgb[0, 0].tolist() == [0, 0, 200]
        assert abs(time.perf_counter() - frame.delivered) < 2
    finally:
        camera.close()
    assert device.released.wait(5)


def test_size_and_rate_are_asked_for_and_large_pictures_as_jpeg() -> None:
    import cv2

    device = Device(blue)
    camera = open_camera(CHOICE, (1920, 1080), 60, lambda: [CHOICE], lambda index: device)()
    camera.close()
    assert device.asked[cv2.CAP_PROP_FRAME_WIDTH] == 1920
    assert device.asked[cv2.CAP_PROP_FPS] == 60
    assert device.asked[cv2.CAP_PROP_FOURCC] == cv2.VideoWriter.fourcc(*"MJPG")


def test_its_name_is_the_one_by_which_it_is_found_again() -> None:
    camera = opened(Device(blue))
    camera.close()
    assert camera.name == CHOICE.name


def test_it_is_found_by_name_wherever_it_is_plugged_in() -> None:
    indices: list[int] = []

    def open_device(index: int) -> Device:
        indices.append(index)
        return Device(blue)

    moved = [CameraChoice("Other", 0), CameraChoice("Cam", 4)]
    open_camera(CHOICE, connected=lambda: moved, open_device=open_device)().close()
    assert indices == [4]


def test_of_two_that_are_called_the_same_neither_is_taken_for_the_other() -> None:
    indices: list[int] = []
    left = CameraChoice("Cam", 0, place="usb-1", twin=True)
    right = CameraChoice("Cam (2)", 2, place="usb-2", twin=True)

    def opened_index(choice: CameraChoice, connected: list[CameraChoice]) -> int:
        open_camera(choice, connected=lambda: connected, open_device=lambda index: taken(index))().close()
        return indices[-1]

    def taken(index: int) -> Device:
        indices.append(index)
        return Device(blue)

    assert opened_index(right, [left, right]) == 2
    assert opened_index(right, [CameraChoice("Cam", 7, place="usb-2")]) == 7
    with pytest.raises(SourceLost, match="Cam is not connected"):
        opened_index(left, [CameraChoice("Cam", 2, place="usb-2")])


def test_one_that_is_not_there_may_come_back() -> None:
    with pytest.raises(SourceLost, match="Cam is not connected") as raised:
        opened(Device(blue), connected=[])
    assert raised.value.retry


@pytest.mark.parametrize("system", list(CURES))
def test_one_that_is_refused_says_what_to_do_here(system: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", system)
    device = Device(blue, opened=False)
    with pytest.raises(SourceLost, match="cannot be opened") as raised:
        opened(device)
    assert CURES[system] in raised.value.cure
    assert "demo" in raised.value.cure
    assert device.released.is_set()


def test_one_that_takes_its_time_to_wake_up_is_waited_for() -> None:
    pictures = iter([None] * 12 + [blue()])
    clock = iter(np.arange(0, 10000, 0.3))
    camera = opened(Device(lambda: next(pictures, blue())), clock=lambda: float(next(clock)))
    assert read_on(camera).rgb.any()
    camera.close()


def test_one_that_goes_away_is_lost_and_let_go() -> None:
    device = Device(lambda: None)
    clock = iter(np.arange(0, 10000, 0.3))
    camera = opened(device, clock=lambda: float(next(clock)))
    with pytest.raises(SourceLost, match="went away") as raised:
        read_on(camera)
    assert raised.value.retry
    assert device.released.wait(5)


def test_garbage_of_a_driver_is_counted_and_grey_is_made_colour() -> None:
    images = iter(["text", np.zeros((0, 0, 3), np.uint8), np.zeros((4, 4, 3)), np.zeros((4, 4, 2), np.uint8)])
    grey = np.full((48, 64), 77, np.uint8)
    camera = opened(Device(lambda: next(images, grey)))
    frame = camera.read(5)
    camera.close()
    assert isinstance(frame, TimedFrame)
    assert frame.rgb.shape == (48, 64, 3)
    assert camera.rejected == 4


def test_a_driver_that_raises_is_lost_in_words() -> None:
    def fail() -> object:
        raise RuntimeError("select() timeout")

    camera = opened(Device(fail))
    with pytest.raises(SourceLost, match="select"):
        read_on(camera)


def test_closing_does_not_wait_for_a_device_that_hangs() -> None:
    go_on = threading.Event()
    device = Device(lambda: go_on.wait(30) and None)
    camera = opened(device)
    begun = time.perf_counter()
    assert camera.read(0.01) is None
    camera.close()
    assert time.perf_counter() - begun < 1
    go_on.set()
    assert device.released.wait(5)


def test_the_cameras_of_this_machine_can_be_listed() -> None:
    names = [camera.name for camera in cameras()]
    assert len(set(names)) == len(names)


def test_cameras_of_one_name_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    import cv2_enumerate_cameras as listing

    twins = [listing.CameraInfo(index, "Twin", f"/dev/video{index}", None, None, 0) for index in (2, 0)]
    monkeypatch.setattr(listing, "enumerate_cameras", lambda backend: twins)
    assert [(camera.name, camera.path, camera.twin) for camera in cameras()] == [
        ("Twin", "/dev/video0", True),
        ("Twin (2)", "/dev/video2", True),
    ]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows links only for administrators")
def test_where_a_camera_is_plugged_in_is_what_linux_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import cv2_enumerate_cameras as listing

    device = tmp_path / "video3"
    device.touch()
    (tmp_path / "places").mkdir()
    (tmp_path / "places" / "usb-1:2").symlink_to(device)
    monkeypatch.setattr(camera, "BY_PLACE", tmp_path / "places")
    found = [listing.CameraInfo(3, "Cam", str(device), None, None, 0)]
    monkeypatch.setattr(listing, "enumerate_cameras", lambda backend: found)
    assert [choice.place for choice in cameras()] == [str(tmp_path / "places" / "usb-1:2")]
