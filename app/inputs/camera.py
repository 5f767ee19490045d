"""A camera chosen by its name, read in a thread of its own: the newest picture wins, and a hang harms nobody."""

import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..performing.mailbox import Mailbox
from .source import Kind, LiveSource, Opener, SourceLost, TimedFrame
from .vigil import FIRST_SECS, GONE_SECS

MICROSECOND = Fraction(1, 1_000_000)
BY_PLACE = Path("/dev/v4l/by-path")
_PAUSE_SECS = 0.01
_BY_WIRE = (640, 480)
"""Larger pictures do not fit through USB 2 uncompressed at full rate; then Motion JPEG is asked for."""

CURES = {
    "linux": "Close other programs that use it, or allow it: sudo usermod -aG video $USER, then log in anew.",
    "darwin": "Close other programs that use it, and allow it in System Settings, Privacy & Security, Camera.",
    "win32": "Close other programs that use it (Teams, Zoom, Camera), and allow it in Settings, Privacy, Camera.",
}
"""What to do about a camera that is busy or refused."""


@dataclass(frozen=True)
class CameraChoice:
    """One camera that is connected."""

    name: str
    """As its maker calls it; with a number behind it where two are called the same."""
    index: int
    """What OpenCV calls it now; it changes when cameras are plugged in."""
    path: str = ""
    """Where the system keeps it, as far as it says."""
    place: str = ""
    """The same by where it is plugged in, which stays when cameras come and go; as far as the system says."""
    twin: bool = False
    """Whether another one is called the same: then only its place tells them apart."""


def cameras() -> list[CameraChoice]:
    """The cameras that are connected, by one backend of this system; empty where none is, or none can be listed."""
    import cv2
    from cv2_enumerate_cameras import enumerate_cameras, supported_backends

    wanted = {"linux": cv2.CAP_V4L2, "darwin": cv2.CAP_AVFOUNDATION, "win32": cv2.CAP_DSHOW}.get(sys.platform)
    try:
        backend = wanted if wanted in supported_backends else cv2.CAP_ANY
        found = sorted(enumerate_cameras(backend), key=lambda camera: camera.index)
    except (OSError, RuntimeError, NotImplementedError):
        return []
    called = [camera.name or f"camera {camera.index}" for camera in found]
    choices: list[CameraChoice] = []
    for number, (camera, name) in enumerate(zip(found, called, strict=True)):
        before, path = called[:number].count(name), str(camera.path or "")
        unique = f"{name} ({before + 1})" if before else name
        index, twin = camera.index + (camera.backend or 0), called.count(name) > 1
        choices.append(CameraChoice(unique, index, path, _place_of(path), twin))
    return choices


def _place_of(path: str) -> str:
    """Linux calls cameras /dev/video0 and so on as they come, and says beside that which socket each is in."""
    links = sorted(BY_PLACE.glob("*")) if BY_PLACE.is_dir() else ()
    return next((str(link) for link in links if link.resolve() == Path(path).resolve()), path)


Device = Any
"""What ``cv2.VideoCapture`` offers: isOpened, read, set, release."""


def open_camera(
    choice: CameraChoice,
    size: tuple[int, int] = (640, 480),
    rate: float = 30.0,
    connected: Callable[[], list[CameraChoice]] = cameras,
    open_device: Callable[[int], Device] | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> Opener:
    """What opens the camera of this name, wherever it is plugged in by then.

    Args:
        choice: one of ``cameras()``.
        size: width and height asked for; the camera may give others.
        rate: frames a second asked for.
        connected: lists the cameras.
        open_device: opens one by its index (default: OpenCV).
        clock: stamps the frames.
    """

    def open_now() -> LiveSource:
        by_place = choice.twin and choice.place  # else the one of two that is left would be taken for the other
        fits = [one for one in connected() if (one.place == choice.place if by_place else one.name == choice.name)]
        now = fits[0] if fits else None
        if now is None:
            raise SourceLost(f"{choice.name} is not connected.", "Plug it in; it is used as soon as it is there.", True)
        device = (open_device or _opencv)(now.index)
        if not device.isOpened():
            device.release()
            raise SourceLost(f"{choice.name} cannot be opened.", f"{_cure()} Or play the demo meanwhile.", True)
        return Camera(choice.name, device, size, rate, clock)

    return open_now


class Camera:
    """An opened camera and the thread that reads it."""

    kind: Kind = "camera"
    transport = None

    def __init__(
        self, name: str, device: Device, size: tuple[int, int], rate: float, clock: Callable[[], float]
    ) -> None:
        self.name = name
        """The camera's alone: by it the camera is found again, and its neutral kept."""
        self._device, self._clock = device, clock
        self._box: Mailbox[TimedFrame] = Mailbox()
        self._stopped = threading.Event()
        self._lost: SourceLost | None = None
        self.rejected = 0
        _ask_for(device, size, rate)
        self._thread = threading.Thread(target=self._run, name=f"camera {name}", daemon=True)
        self._thread.start()

    @property
    def drops(self) -> int:
        """Pictures that were too old to be looked at."""
        return self._box.dropped

    def read(self, timeout: float) -> TimedFrame | None:
        """The newest picture. Raises SourceLost when the camera went away."""
        frame = self._box.take(timeout)
        if frame is None and self._lost is not None:
            raise self._lost
        return frame

    def close(self) -> None:
        """The reading thread lets go of the device, as soon as the device lets go of it."""
        self._stopped.set()

    def _run(self) -> None:
        started = good = self._clock()
        patience = FIRST_SECS
        try:
            while not self._stopped.is_set():
                picture = self._picture()
                now = self._clock()
                if picture is not None:
                    good, patience = now, GONE_SECS
                    pts = round((now - started) / MICROSECOND)
                    self._box.put(TimedFrame(picture, pts, MICROSECOND, delivered=now))
                elif now - good > patience:
                    raise SourceLost(
                        f"{self.name} went away.", "Plug it in again; it is used as soon as it is there.", True
                    )
                else:
                    self._stopped.wait(_PAUSE_SECS)
        except SourceLost as lost:
            self._lost = lost
        except Exception as error:  # drivers raise what they like; the loop is to hear of it
            self._lost = SourceLost(f"{self.name} failed ({error}).", _cure(), True)
        finally:
            self._device.release()

    def _picture(self) -> NDArray[np.uint8] | None:
        """[H, W, 3] RGB; None when the device gave nothing, or something else."""
        import cv2

        given, image = self._device.read()
        if not given:
            return None
        if not isinstance(image, np.ndarray) or image.dtype != np.uint8 or image.size == 0 or image.ndim not in (2, 3):
            self.rejected += 1
            return None
        if image.ndim == 2 or image.shape[2] == 1:
            return np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2RGB), np.uint8)
        if image.shape[2] != 3:
            self.rejected += 1
            return None
        return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), np.uint8)


def _ask_for(device: Device, size: tuple[int, int], rate: float) -> None:
    """Ask for a size and a rate; the device may give others."""
    import cv2

    if size[0] * size[1] > _BY_WIRE[0] * _BY_WIRE[1]:
        device.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
    device.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
    device.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
    device.set(cv2.CAP_PROP_FPS, rate)
    device.set(cv2.CAP_PROP_BUFFERSIZE, 1)  # where it is understood: an older picture than the newest is of no use


def _opencv(index: int) -> Device:
    import cv2

    cv2.setLogLevel(2)  # errors only: that a camera is not there is said in our words
    return cv2.VideoCapture(index)


def _cure() -> str:
    return CURES.get(sys.platform, "Close other programs that use it, and allow programs to use cameras.")
