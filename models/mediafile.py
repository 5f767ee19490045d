"""Opening videos of unknown origin: plain containers only, and nothing but the one file; what all who read them share.

FFmpeg tells formats by their content: what is called clip.mp4 may be a playlist that names addresses on the network or
other files of this machine. Such formats are not read, and no protocol but that of local files is spoken.
"""

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import av

from .movieheader import fragments_say_when

CONTAINERS = (
    *("mov", "matroska", "webm", "avi", "mpegts", "mpeg", "mpegvideo", "flv", "ogg", "asf", "gif", "ivf", "mjpeg"),
    *("h264", "hevc", "m4v", "obu", "yuv4mpegpipe", "wav", "mp3", "aac", "flac"),
)
"""FFmpeg's names of what is read; everything in them lies within the file."""
_LOCAL = "file:"
"""The protocol of what lies on this machine."""
MAX_PIXELS = 2**25
"""8K; a larger picture is an error of the decoder, which may hold some twenty of them."""
MAX_RATE = 1000
MAX_PIXEL_ASPECT = 4
"""Anamorphic lenses and halved pictures come to 2; what says more, or less than its inverse, is a mistake."""


def open_media(path: Path) -> Any:
    """An opened container of PyAV, to be closed by the caller. Raises av.error.FFmpegError and OSError."""
    options = {"protocol_whitelist": "file", "format_whitelist": ",".join(CONTAINERS)}
    # a name with a colon, such as 10:30.mp4, would else begin with the protocol to be spoken
    container = av.open(f"{_LOCAL}{path}", options=options, metadata_errors="replace")
    for stream in container.streams.video:
        if stream.codec_context is not None:
            stream.codec_context.options = {"max_pixels": str(MAX_PIXELS)}
    return container


def main_video(container: Any) -> Any | None:
    """The largest stream that is a video and no cover picture, of several as large the first; its ``codec_context`` is
    None where nothing decodes it."""
    attached = getattr(av.stream.Disposition, "attached_pic", 0)
    videos = [stream for stream in container.streams.video if not stream.disposition & attached]
    return max(videos, key=_pixels, default=None)


def _pixels(stream: Any) -> int:
    context = stream.codec_context
    return 0 if context is None else context.width * context.height


def rate_of(stream: Any) -> Fraction:
    """Frames per second of a video stream as it says, 30 where it says nothing of use."""
    for rate in (stream.average_rate, stream.guessed_rate):
        if rate and 0 < rate <= MAX_RATE:
            return Fraction(rate)
    return Fraction(30)


def duration_of(container: Any, stream: Any) -> Fraction | None:
    """Seconds of a stream; Matroska, WebM and FLV tell it of the whole file alone. None where nobody does."""
    if stream.duration and stream.time_base:
        length = Fraction(stream.duration * stream.time_base)
        before = _first_decoded(container, stream) if _is_movie(container) and start_of(container) else Fraction(0)
        return length - before if length > before else length
    return Fraction(container.duration, av.time_base) if container.duration else None


def _first_decoded(container: Any, stream: Any) -> Fraction:
    """When the first picture of a stream is decoded, in seconds: from 0 to there FFmpeg counts, too, how long fragments
    of a running stream are. It is earlier than the first one is shown where pictures are stored in another order."""
    try:
        with open_media(_path_of(container)) as again:  # the other one goes on where it is
            dts = next(again.demux(again.streams[stream.index])).dts
    except (av.error.FFmpegError, OSError):
        dts = None
    return start_of(container) if dts is None else Fraction(max(0, dts) * stream.time_base)


def start_of(container: Any) -> Fraction:
    """Where the clock of a file begins, in seconds, at least 0.

    That of a transport stream or of what was cut from a broadcast begins anywhere. MP4 and MOV have a timeline of their
    own: there a late first picture is meant to be late, but in fragments of a running stream.
    """
    if not container.start_time or (_is_movie(container) and not fragments_say_when(_path_of(container))):
        return Fraction(0)
    return Fraction(max(0, container.start_time), av.time_base)


def _is_movie(container: Any) -> bool:
    return "mov" in container.format.name.split(",")


def _path_of(container: Any) -> Path:
    return Path(container.name.removeprefix(_LOCAL))


def pixel_aspect_of(stream: Any) -> Fraction:
    """Width over height of a video stream's pixels; 1 where it says nothing, or nothing of use."""
    aspect = stream.sample_aspect_ratio
    return Fraction(aspect) if aspect and 1 / MAX_PIXEL_ASPECT <= aspect <= MAX_PIXEL_ASPECT else Fraction(1)


def decoded(container: Any, stream: Any) -> Iterator[av.VideoFrame]:
    """The stream's pictures; a packet that cannot be decoded is passed over, the next ones still count."""
    for packet in container.demux(stream):
        try:
            yield from packet.decode()
        except av.error.InvalidDataError:
            continue
