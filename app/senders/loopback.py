"""A v4l2loopback camera of Linux: finding it, and writing pictures to it.

Spoken directly, without a library: two ioctls of linux/videodev2.h, then plain writes of one picture each.
"""

import errno
import os
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import av
import numpy as np

from ...render.arrays import Image
from ..errors import OutputError
from .fitting import Size

SYSTEM_FOLDER = Path("/sys/class/video4linux")
DEVICES = Path("/dev")
VIDIOC_QUERYCAP = 0x80685600
VIDIOC_S_FMT = 0xC0D05605
BUF_TYPE_VIDEO_OUTPUT = 2
CAP_VIDEO_OUTPUT, CAP_DEVICE_CAPS = 0x2, 0x80000000
FIELD_NONE, COLORSPACE_SMPTE170M = 1, 1
PIXEL_FORMAT = b"YUYV"
"""4:2:2, 16 bits a pixel, BT.601 limited range: what every program that shows a camera reads."""
CAPABILITY = struct.Struct("16s32s32sIII12x")
"""v4l2_capability: driver, card, bus, version, capabilities, capabilities of this device."""
FORMAT = struct.Struct("=I4xII4sIIIIIIIII152x")
"""v4l2_format with v4l2_pix_format: type, width, height, pixels, field, bytes a line, bytes a picture, colorspace,
and five that are left to the driver."""
MAKE_ONE = 'sudo modprobe v4l2loopback devices=1 card_label="gemheads" exclusive_caps=1'
INSTALL = "Debian, Ubuntu: sudo apt install v4l2loopback-dkms"

Ioctl = Callable[[int, int, bytearray], int]


@dataclass(frozen=True)
class Loopback:
    """One device that other programs see as a camera."""

    path: Path
    name: str
    """As those programs show it."""


def loopbacks(system: Path = SYSTEM_FOLDER, devices: Path = DEVICES) -> list[Loopback]:
    """The virtual video devices of this machine, by number."""
    found = []
    for entry in system.glob("video*") if system.is_dir() else ():
        # A real camera hangs on a bus; what a driver makes up lives under devices/virtual.
        if "virtual" in entry.resolve().parts and entry.name[5:].isdecimal():
            try:
                name = (entry / "name").read_text("utf-8").strip()
            except OSError:
                continue
            found.append((int(entry.name[5:]), Loopback(devices / entry.name, name)))
    return [device for _, device in sorted(found, key=lambda item: item[0])]


class LoopbackCamera:
    """An opened device of one size, to which pictures are written."""

    def __init__(self, device: Loopback, size: Size, ioctl: Ioctl | None = None) -> None:
        """``size``: even width and height in pixels; ``ioctl``: fcntl.ioctl. Raises OutputError with the cure."""
        self.name = f"{device.name} ({device.path})"
        self._device, self._size = device, size
        ioctl = ioctl or _system_ioctl()
        try:
            self._file = os.open(device.path, os.O_RDWR)
        except OSError as error:
            raise self._told(error) from error
        try:
            self._agree(ioctl)
        except OSError as error:
            os.close(self._file)
            raise self._told(error) from error
        except OutputError:
            os.close(self._file)
            raise

    def send(self, rgb: Image) -> None:
        """Write one picture [height, width, 3] of the camera's size. Raises OutputError."""
        data = yuyv(rgb).tobytes()
        try:
            written = os.write(self._file, data)
        except OSError as error:
            raise self._told(error) from error
        if written != len(data):
            raise OutputError(f"{self.name}: took {written} of {len(data)} bytes of a picture; {self._again()}")

    def close(self) -> None:
        """Let the device go."""
        os.close(self._file)

    def _agree(self, ioctl: Ioctl) -> None:
        """Make sure that it takes pictures, of this size and kind."""
        answer = bytearray(CAPABILITY.size)
        ioctl(self._file, VIDIOC_QUERYCAP, answer)
        _, _, _, _, whole, device = CAPABILITY.unpack(answer)
        if not (device if whole & CAP_DEVICE_CAPS else whole) & CAP_VIDEO_OUTPUT:
            raise OutputError(f"{self.name}: takes no pictures, it is no loopback camera; make one: {MAKE_ONE}")
        width, height = self._size
        wanted = (width, height, PIXEL_FORMAT, FIELD_NONE, 2 * width, 2 * width * height, COLORSPACE_SMPTE170M)
        answer = bytearray(FORMAT.pack(BUF_TYPE_VIDEO_OUTPUT, *wanted, 0, 0, 0, 0, 0))
        ioctl(self._file, VIDIOC_S_FMT, answer)
        _, given_width, given_height, pixels, _, line, *_ = FORMAT.unpack(answer)
        if (given_width, given_height, pixels, line) != (width, height, PIXEL_FORMAT, 2 * width):
            kind = pixels.decode("ascii", "replace")
            raise OutputError(
                f"{self.name}: is set to {given_width}x{given_height} {kind}, not {width}x{height} YUYV: another"
                f" program uses it; close that program's camera, or {self._again()}"
            )

    def _told(self, error: OSError) -> OutputError:
        cures = {
            errno.EACCES: "this user may not use it; sudo usermod -aG video $USER, then log in again",
            errno.EPERM: "this user may not use it; sudo usermod -aG video $USER, then log in again",
            errno.EBUSY: "another program writes to it (OBS?); stop its virtual camera first",
            errno.ENOENT: f"is not there any more; {self._again()}",
            errno.ENODEV: f"is not there any more; {self._again()}",
            errno.ENOTTY: f"is no video device; make one: {MAKE_ONE}",
        }
        return OutputError(f"{self.name}: {cures.get(error.errno or 0, f'{error.strerror}; {self._again()}')}")

    def _again(self) -> str:
        return f"make it anew: sudo modprobe -r v4l2loopback && {MAKE_ONE}"


def yuyv(rgb: Image) -> Image:
    """[height, width, 2] bytes Y U Y V of an RGB picture [height, width, 3], BT.601 limited range."""
    frame = av.VideoFrame.from_ndarray(rgb, format="rgb24").reformat(format="yuyv422")
    return frame.to_ndarray().astype(np.uint8, copy=False)


def _system_ioctl() -> Ioctl:
    import fcntl

    return lambda file, request, data: fcntl.ioctl(file, request, data, True)
