"""From a word to a source: files, folders, what ships, and ports to listen on."""

import time
from collections.abc import Callable
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

from ..errors import InputError, UsageError
from ..files.sources import IMAGE_SUFFIXES
from ..files.tensorfile import is_tensor_file
from ..library import demo_clip
from .oscin import LOOPBACK, PORTS, FaceData
from .source import LiveSource, Opener

DEMO = "demo"
"""The clip of a face that ships."""
PERFORMANCE = "performance"
"""The one that ships, in ARKit weights: it needs no tracking."""


def open_input(text: str, clock: Callable[[], float] = time.perf_counter) -> Opener:
    """What opens a source, but no camera: DEMO, PERFORMANCE, a video, a picture or folder of them, a track,
    ``osc:PORT`` (VMC), ``ifacialmocap:PORT``, each also ``:HOST:PORT``.

    Raises UsageError for a port that is none; all else is found out when it is opened.
    """
    protocol, _, address = text.partition(":")
    if protocol.lower() in PORTS and not Path(text).exists():
        host, port = _address(text, protocol.lower(), address)
        return lambda: FaceData(protocol.lower(), port, host, clock)
    return lambda: _open_path(text, clock)


def check_input(text: str) -> None:
    """Raises InputError for a word that plainly names nothing; all else is found out when it is opened."""
    known = text in (DEMO, PERFORMANCE) or text.partition(":")[0].lower() in PORTS
    if not known and not _is_pattern(text) and not Path(text).expanduser().exists():
        raise InputError(f"{text}: no such file or folder; check the path")


def plain_path(words: str) -> str:
    """A path as people paste it: without the quotes that some systems copy with it, and out of a file:// address."""
    words = words.strip()
    if len(words) > 1 and words[0] == words[-1] and words[0] in "\"'":
        words = words[1:-1]
    return url2pathname(urlsplit(words).path) if words.lower().startswith("file:///") else words


def _is_pattern(text: str) -> bool:
    return any(sign in Path(text).name for sign in "*?[%")


def _open_path(text: str, clock: Callable[[], float]) -> LiveSource:
    from .pictures import open_pictures
    from .trackplayer import open_performance, open_track
    from .videoplayer import VideoPlayer

    path = Path(text).expanduser()
    if text == DEMO and not path.exists():
        return VideoPlayer(demo_clip(), clock, "The demo")
    if text == PERFORMANCE and not path.exists():
        return open_performance(clock)
    if path.suffix.lower() == ".safetensors" or is_tensor_file(path):
        return open_track(path, clock)
    if path.is_file() and path.suffix.lower() not in IMAGE_SUFFIXES:
        return VideoPlayer(path, clock)
    check_input(text)
    return open_pictures(path, clock=clock)


def _address(text: str, protocol: str, address: str) -> tuple[str, int]:
    host, _, port = address.rpartition(":")
    if not address:
        return LOOPBACK, PORTS[protocol]
    if not port.isdecimal() or not 0 <= int(port) <= 65535:
        raise UsageError(f"{text}: no port; write {protocol}:{PORTS[protocol]} or {protocol}:HOST:{PORTS[protocol]}")
    return host or LOOPBACK, int(port)
