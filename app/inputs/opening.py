"""From a word to a source: files, folders, the demo, and ports to listen on."""

import time
from collections.abc import Callable
from pathlib import Path

from ..errors import InputError, UsageError
from ..files.sources import IMAGE_SUFFIXES
from ..files.tensorfile import is_tensor_file
from .oscin import LOOPBACK, PORTS, FaceData
from .source import LiveSource, Opener

DEMO_WORD = "demo"


def open_input(text: str, clock: Callable[[], float] = time.perf_counter) -> Opener:
    """What opens a source, but no camera: ``demo``, a video, a picture or folder of them, a track, ``osc:PORT``
    (VMC), ``ifacialmocap:PORT``, each also ``:HOST:PORT``.

    Raises UsageError for a port that is none; all else is found out when it is opened.
    """
    protocol, _, address = text.partition(":")
    if protocol.lower() in PORTS and not Path(text).exists():
        host, port = _address(text, protocol.lower(), address)
        return lambda: FaceData(protocol.lower(), port, host, clock)
    return lambda: _open_path(text, clock)


def _open_path(text: str, clock: Callable[[], float]) -> LiveSource:
    from .pictures import open_pictures
    from .trackplayer import open_demo, open_track
    from .videoplayer import VideoPlayer

    path = Path(text).expanduser()
    if text == DEMO_WORD and not path.exists():
        return open_demo(clock)
    if path.suffix.lower() == ".safetensors" or is_tensor_file(path):
        return open_track(path, clock)
    if path.is_file() and path.suffix.lower() not in IMAGE_SUFFIXES:
        return VideoPlayer(path, clock)
    if not path.exists() and not any(sign in path.name for sign in "*?[%"):
        raise InputError(f"{text}: no such file or folder; check the path")
    return open_pictures(path, clock=clock)


def _address(text: str, protocol: str, address: str) -> tuple[str, int]:
    host, _, port = address.rpartition(":")
    if not address:
        return LOOPBACK, PORTS[protocol]
    if not port.isdecimal() or not 0 <= int(port) <= 65535:
        raise UsageError(f"{text}: no port; write {protocol}:{PORTS[protocol]} or {protocol}:HOST:{PORTS[protocol]}")
    return host or LOOPBACK, int(port)
