"""Cameras by name, and which files are avatars."""

import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from ..inputs import cameras, open_camera
from ..inputs.source import LiveSource, Opener, SourceLost
from ..library import SUFFIX

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


def camera_named(name: str) -> Opener:
    """What opens a camera: the one of this name, or one whose name has it in it, or the first where ``name`` is empty.

    Which one that is, is found out when it is opened. Once it was, no other one is opened in its place.
    """
    known: Opener | None = None

    def opened() -> LiveSource:
        nonlocal known
        if known is not None:
            return known()
        found = cameras()
        meant = named([camera.name for camera in found], name)
        if meant is not None:
            opener = open_camera(next(camera for camera in found if camera.name == meant))
            source, known = opener(), opener
            return source
        names = ", ".join(camera.name for camera in found)
        if not names:
            raise SourceLost("There is no camera.", "Plug one in, or choose the demo or a video.", retry=True)
        raise SourceLost(f"There is no camera called {name}.", f"Choose one of: {names}.", retry=True)

    return opened


def named(names: Sequence[str], word: str) -> str | None:
    """The camera that a word means, of all ``names``; live.toml of an earlier version has size and rate behind them."""
    fits: tuple[Callable[[str], bool], ...] = (
        lambda name: name == word,
        lambda name: word.lower() in name.lower(),
        lambda name: word.startswith(f"{name}, "),
    )
    return next((name for fit in fits for name in names if fit(name)), None)


def is_avatar(text: str) -> bool:
    """Whether this is the file of an avatar, by its name."""
    return Path(text).suffix.lower() == SUFFIX
