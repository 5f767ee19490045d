import ctypes
import errno
import os
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from gemheads.app.errors import OutputError
from gemheads.app.senders import loopback, virtualcamera
from gemheads.app.senders.loopback import Loopback, LoopbackCamera, loopbacks
from gemheads.app.senders.outlet import Shown
from gemheads.app.senders.virtualcamera import CHROMA_GREEN, VirtualCamera, open_virtual_camera
from gemheads.render.arrays import Image


class PixFormat(ctypes.Structure):
    """v4l2_pix_format of linux/videodev2.h, written down a second time."""

    _fields_ = [
        (name, ctypes.c_uint32)
        for name in (
            *("width", "height", "pixelformat", "field", "bytesperline", "sizeimage", "colorspace"),
            *("priv", "flags", "ycbcr_enc", "quantization", "xfer_func"),
        )
    ]


class Union(ctypes.Union):
    _fields_ = [("pix", PixFormat), ("raw", ctypes.c_uint8 * 200), ("pointer", ctypes.c_void_p)]


class Format(ctypes.Structure):
    _fields_ = [("type", ctypes.c_uint32), ("fmt", Union)]


class Capability(ctypes.Structure):
    _fields_ = [
        ("driver", ctypes.c_char * 16),
        ("card", ctypes.c_char * 32),
        ("bus_info", ctypes.c_char * 32),
        ("version", ctypes.c_uint32),
        ("capabilities", ctypes.c_uint32),
        ("device_caps", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32 * 3),
    ]


def request(direction: int, number: int, size: int) -> int:
    """_IOC of asm-generic/ioctl.h for the letter V."""
    return direction << 30 | size << 16 | ord("V") << 8 | number


class Driver:
    """Answers as v4l2loopback does, and reads what was written to its file."""

    def __init__(self, path: Path) -> None:
        path.touch()
        self.path = path
        self.caps = 0x80000000 | 0x05000002
        self.device_caps = 0x05000002
        self.held: tuple[int, int] | None = None
        self.format: PixFormat | None = None

    def ioctl(self, file: int, number: int, data: bytearray) -> int:
        if number == request(2, 0, ctypes.sizeof(Capability)):
            answer = Capability.from_buffer(data)
            answer.driver, answer.capabilities, answer.device_caps = b"v4l2 loopback", self.caps, self.device_caps
        elif number == request(3, 5, ctypes.sizeof(Format)):
            wanted = Format.from_buffer(data)
            assert wanted.type == 2
            if self.held:
                wanted.fmt.pix.width, wanted.fmt.pix.height = self.held
            self.format = PixFormat.from_buffer_copy(wanted.fmt.pix)
        else:
            raise OSError(errno.ENOTTY, "Inappropriate ioctl for device")
        return 0

    def pictures(self) -> list[Image]:
        """What a program that reads the camera sees, by another decoder than the one that wrote."""
        assert self.format is not None
        pix = self.format
        assert pix.pixelformat == int.from_bytes(b"YUYV", "little")
        assert pix.sizeimage == pix.bytesperline * pix.height
        data = np.frombuffer(self.path.read_bytes(), np.uint8)
        assert len(data) % pix.sizeimage == 0
        shape = (-1, pix.height, pix.bytesperline // 2, 2)
        return [cv2.cvtColor(raw, cv2.COLOR_YUV2RGB_YUYV) for raw in data.reshape(shape)]  # pyright: ignore[reportReturnType]


@pytest.fixture
def driver(tmp_path: Path) -> Driver:
    return Driver(tmp_path / "video7")


def opened(driver: Driver, size: tuple[int, int] = (32, 16)) -> LoopbackCamera:
    return LoopbackCamera(Loopback(driver.path, "gemheads"), size, driver.ioctl)


def coloured(size: tuple[int, int]) -> Image:
    image = np.empty((size[1], size[0], 3), np.uint8)
    image[:, : size[0] // 2], image[:, size[0] // 2 :] = (220, 40, 30), (20, 90, 230)
    return image


def test_a_reader_sees_the_colours_that_were_written(driver: Driver) -> None:
    camera = opened(driver)
    for _ in range(3):
        camera.send(coloured((32, 16)))
    camera.close()
    pictures = driver.pictures()
    assert len(pictures) == 3
    assert np.abs(pictures[2][:, 2:14].astype(int) - (220, 40, 30)).max() <= 6
    assert np.abs(pictures[2][:, 18:30].astype(int) - (20, 90, 230)).max() <= 6


def test_any_picture_fits_and_transparency_is_green(driver: Driver) -> None:
    camera = VirtualCamera(opened(driver), (32, 16))
    camera.send(Shown(np.dstack([coloured((64, 32)), np.full((32, 64), 255, np.uint8)]), 0.0))
    camera.send(Shown(np.zeros((5, 9, 4), np.uint8), 0.1))
    camera.send(Shown(coloured((16, 16)), 0.2))
    assert camera.status == f"shown as gemheads ({driver.path}), 32x16"
    camera.close()
    small, clear, narrow = driver.pictures()
    assert np.abs(small[8, 4].astype(int) - (220, 40, 30)).max() <= 6
    assert np.abs(clear.astype(int) - CHROMA_GREEN).max() <= 6
    assert np.abs(narrow[8, 2].astype(int) - CHROMA_GREEN).max() <= 6


def test_a_camera_that_takes_no_pictures_is_refused(driver: Driver) -> None:
    driver.device_caps = 0x04200001  # a webcam: capture only
    with pytest.raises(OutputError, match=r"takes no pictures.*modprobe v4l2loopback"):
        opened(driver)


def test_a_device_that_another_program_holds_at_its_size_is_refused(driver: Driver) -> None:
    driver.held = (1280, 720)
    with pytest.raises(OutputError, match=r"is set to 1280x720 YUYV, not 32x16.*close that program"):
        opened(driver)


def test_a_file_that_is_no_device_says_how_to_make_one(tmp_path: Path) -> None:
    (tmp_path / "video9").touch()
    with pytest.raises(OutputError, match="is no video device; make one: sudo modprobe v4l2loopback"):
        LoopbackCamera(Loopback(tmp_path / "video9", "video9"), (32, 16))
    with pytest.raises(OutputError, match="is not there any more"):
        LoopbackCamera(Loopback(tmp_path / "video10", "video10"), (32, 16))


@pytest.mark.parametrize(
    ("number", "cure"),
    [(errno.EACCES, "usermod -aG video"), (errno.EBUSY, "stop its virtual camera"), (errno.EIO, "make it anew")],
)
def test_each_refusal_has_its_cure(driver: Driver, monkeypatch: pytest.MonkeyPatch, number: int, cure: str) -> None:
    def refuse(*_: object) -> int:
        raise OSError(number, os.strerror(number))

    with monkeypatch.context() as patched:
        patched.setattr(os, "open", refuse)
        with pytest.raises(OutputError, match=cure):
            opened(driver)
    camera = opened(driver)
    with monkeypatch.context() as patched:
        patched.setattr(os, "write", refuse)
        with pytest.raises(OutputError, match=cure):
            camera.send(coloured((32, 16)))
    camera.close()


def test_only_made_up_devices_are_found_and_in_order(tmp_path: Path) -> None:
    system = tmp_path / "class"
    system.mkdir()
    for number, folder in ((10, "devices/virtual"), (9, "devices/virtual"), (0, "devices/pci0000:00/usb1")):
        real = tmp_path / folder / "video4linux" / f"video{number}"
        real.mkdir(parents=True)
        (real / "name").write_text(f"Camera {number}\n")
        (system / real.name).symlink_to(real)
    found = loopbacks(system, tmp_path / "dev")
    assert found == [
        Loopback(tmp_path / "dev" / "video9", "Camera 9"),
        Loopback(tmp_path / "dev" / "video10", "Camera 10"),
    ]
    assert loopbacks(tmp_path / "none") == []


def test_without_a_device_the_cure_is_one_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(virtualcamera, "loopbacks", list)
    with pytest.raises(OutputError, match=r"sudo modprobe v4l2loopback .*apt install v4l2loopback-dkms"):
        open_virtual_camera((512, 512))


def test_other_systems_use_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setitem(sys.modules, "pyvirtualcam", None)
    with pytest.raises(OutputError, match=r"pip install gemheads\[camera\]"):
        open_virtual_camera((512, 512))
    sent: list[Any] = []
    device = SimpleNamespace(device="OBS Virtual Camera", send=sent.append, close=lambda: sent.append("closed"))
    module = SimpleNamespace(Camera=lambda **settings: sent.append(settings) or device)
    monkeypatch.setitem(sys.modules, "pyvirtualcam", module)  # pyright: ignore[reportArgumentType]
    camera = open_virtual_camera((33, 17), rate=25)
    camera.send(Shown(coloured((32, 16)), 0.0))
    assert camera.status == "shown as OBS Virtual Camera, 32x16"
    camera.close()
    assert sent[0] == {"width": 32, "height": 16, "fps": 25, "print_fps": False}
    assert (sent[1] == coloured((32, 16))).all()
    assert sent[2] == "closed"


def test_the_layouts_are_those_of_the_system() -> None:
    assert (loopback.FORMAT.size, loopback.CAPABILITY.size) == (ctypes.sizeof(Format), ctypes.sizeof(Capability))
