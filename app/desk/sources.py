"""From a word to the source behind it: a camera by name, the demo, a file, a port."""

import threading
from pathlib import Path

from ..errors import InputError
from ..inputs import cameras, open_camera, open_input
from ..inputs.source import LiveSource, Opener, SourceLost
from ..library import DEMO_CLIP, SUFFIX

PERFORMANCE = "demo"
"""The shipped performance, which needs no tracking: what plays before anything is chosen."""
LOOK_SECS = 4.0
"""How often the list of cameras is brought up to date."""


class CameraList:
    """The names of the cameras that are connected, looked up in a thread; no camera is opened for it."""

    def __init__(self) -> None:
        self.names: tuple[str, ...] = ()
        self._ended = threading.Event()
        threading.Thread(target=self._run, name="camera list", daemon=True).start()

    def close(self) -> None:
        """Look no more."""
        self._ended.set()

    def _run(self) -> None:
        while not self._ended.is_set():
            self.names = tuple(camera.name for camera in cameras())
            self._ended.wait(LOOK_SECS)


def camera_named(name: str, size: tuple[int, int] = (640, 480), rate: float = 30.0) -> Opener:
    """What opens a camera: the one of this name, or one whose name has it in it, or the first where ``name`` is empty.

    Which one that is, is found out when it is opened.
    """

    def opened() -> LiveSource:
        found = cameras()
        for fits in (lambda camera: camera.name == name, lambda camera: name.lower() in camera.name.lower()):
            for camera in found:
                if fits(camera):
                    return open_camera(camera, size, rate)()
        names = ", ".join(camera.name for camera in found)
        if not names:
            raise SourceLost("There is no camera.", "Plug one in, or choose the demo or a video.", retry=True)
        raise SourceLost(f"There is no camera called {name}.", f"Choose one of: {names}.", retry=True)

    return opened


def demo() -> tuple[Opener, str]:
    """The shipped clip of a face, tracked like any video. Raises InputError when it is missing."""
    if not DEMO_CLIP.is_file():
        raise InputError(f"{DEMO_CLIP}: the demo clip is missing; restore the folder assets/demo")
    return open_input(str(DEMO_CLIP)), "The demo"


def is_avatar(text: str) -> bool:
    """Whether this is the file of an avatar, by its name."""
    return Path(text).suffix.lower() == SUFFIX
