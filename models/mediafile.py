"""Opening videos of unknown origin: plain containers only, and nothing but the one file.

FFmpeg tells formats by their content: what is called clip.mp4 may be a playlist that names addresses on the network or
other files of this machine. Such formats are not read, and no protocol but that of local files is spoken.
"""

from fractions import Fraction
from pathlib import Path
from typing import Any

import av

CONTAINERS = (
    *("mov", "matroska", "webm", "avi", "mpegts", "mpeg", "mpegvideo", "flv", "ogg", "asf", "gif", "ivf", "mjpeg"),
    *("h264", "hevc", "m4v", "obu", "yuv4mpegpipe", "wav", "mp3", "aac", "flac"),
)
"""FFmpeg's names of what is read; everything in them lies within the file."""
MAX_PIXELS = 2**25
"""8K; a larger picture is an error of the decoder, which may hold some twenty of them."""
MAX_RATE = 1000


def open_media(path: Path) -> Any:
    """An opened container of PyAV, to be closed by the caller. Raises av.error.FFmpegError and OSError."""
    options = {"protocol_whitelist": "file", "format_whitelist": ",".join(CONTAINERS)}
    container = av.open(str(path), options=options, metadata_errors="replace")
    for stream in container.streams.video:
        if stream.codec_context is not None:
            stream.codec_context.options = {"max_pixels": str(MAX_PIXELS)}
    return container


def rate_of(stream: Any) -> Fraction:
    """Frames per second of a video stream as it says, 30 where it says nothing of use."""
    for rate in (stream.average_rate, stream.guessed_rate):
        if rate and 0 < rate <= MAX_RATE:
            return Fraction(rate)
    return Fraction(30)
