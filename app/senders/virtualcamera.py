"""The avatar as a camera that a call or a stream can choose."""

import sys
from typing import Any, Protocol

from ...render.arrays import Image
from ..credentials.badge import badged
from ..errors import OutputError
from .fitting import Size, even, fitted
from .loopback import INSTALL, MAKE_ONE, Loopback, LoopbackCamera, loopbacks
from .outlet import Shown

CHROMA_GREEN = (0, 177, 64)
"""Behind what is transparent: a camera knows no alpha, and a stream can key this colour out."""


class Device(Protocol):
    """The one seam to the system: something that takes RGB pictures of one size."""

    name: str

    def send(self, rgb: Image) -> None:
        """One picture [height, width, 3]. Raises OutputError."""
        ...

    def close(self) -> None:
        """Let it go."""
        ...


class VirtualCamera:
    """An outlet into a camera device; pictures of another size are fitted."""

    def __init__(self, device: Device, size: Size) -> None:
        """``size`` is the device's: width and height in pixels."""
        self._device, self._size = device, size
        self.status = f"shown as {device.name}, {size[0]}x{size[1]}"

    def send(self, shown: Shown) -> None:
        """Show one picture. Raises OutputError."""
        picture = fitted(shown.picture, self._size, CHROMA_GREEN)
        self._device.send(badged(picture) if shown.marks.camera_badge else picture)

    def close(self) -> None:
        """Let the device go."""
        self._device.close()
        self.status = "off"


def open_virtual_camera(size: Size, rate: int = 30) -> VirtualCamera:
    """The virtual camera of this system.

    Args:
        size: width and height in pixels; an odd last row or column goes.
        rate: pictures a second, which only other systems need to know.

    Raises:
        OutputError: there is none, or it cannot be used; the text says what to do on this system.
    """
    size = even(size)
    device = LoopbackCamera(_first(), size) if sys.platform == "linux" else _PyVirtualCam(size, rate)
    return VirtualCamera(device, size)


def _first() -> Loopback:
    found = loopbacks()
    if not found:
        raise OutputError(f"no virtual camera: make one: {MAKE_ONE} (if that module is missing, {INSTALL})")
    return found[0]


class _PyVirtualCam:
    """Windows and macOS, by the optional extra pyvirtualcam."""

    def __init__(self, size: Size, rate: int) -> None:
        try:
            import pyvirtualcam  # pyright: ignore[reportMissingImports]
        except ImportError as error:
            raise OutputError(
                "no virtual camera: the extra for this system is not installed; run pip install gemheads[camera]"
            ) from error
        try:
            self._camera: Any = pyvirtualcam.Camera(width=size[0], height=size[1], fps=rate, print_fps=False)
        except Exception as error:  # RuntimeError with the backend's own words
            raise OutputError(f"no virtual camera: {error}; install OBS Studio and start it once") from error
        self.name = str(self._camera.device)

    def send(self, rgb: Image) -> None:
        try:
            self._camera.send(rgb)
        except Exception as error:
            raise OutputError(f"{self.name}: {error}; start the virtual camera again") from error

    def close(self) -> None:
        self._camera.close()
