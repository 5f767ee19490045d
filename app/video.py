"""Reading a video file: upright frames with the file's own timestamps."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np
from av.video.reformatter import Colorspace
from numpy.typing import NDArray

from ..models.mediafile import open_media, rate_of
from .errors import InputError
from .frames import Frame

LONGEST_SIDE = 1920
"""Larger pictures are scaled down while they are converted: the face networks look at crops of 256 pixels."""
WHOLE_CLIP_FRAMES = 1500
"""Up to this many frames, sampling decodes everything; beyond, it seeks."""
FEWEST_SAMPLES = 12
_UNSAID = 2
"""The number of a matrix that a video does not name, in H.273."""


class VideoFile:
    """A video stream of a file. Raises InputError when the file is missing, empty, not a video, or cannot be read."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with open_container(path) as container:
            stream = video_stream(container, path)
            self.time_base: Fraction = stream.time_base or Fraction(1, 1000)
            self.rate = rate_of(stream)
            self.frame_count: int | None = _expected_frames(stream, self.rate)
            self.has_audio = bool(container.streams.audio)
        first = next(self.frames())
        self.size = (first.rgb.shape[1], first.rgb.shape[0])

    def frames(self) -> Iterator[Frame]:
        """All frames in order of presentation; damaged packets are passed over. Raises InputError without any."""
        last: int | None = None
        with _told(self.path), open_container(self.path) as container:
            stream = video_stream(container, self.path)
            stream.thread_type = "AUTO"
            for picture in decoded(container, stream):
                frame = self._frame(picture, last)
                # Encoders need rising timestamps; a repeated one is the same instant and cannot be shown twice.
                if last is None or frame.pts > last:
                    last = frame.pts
                    yield frame
        if last is None:
            raise InputError(f"{self.path}: the clip holds no picture (zero length?); give one with at least one frame")

    def samples(self, count: int) -> list[Frame]:
        """Up to ``count`` frames spread over the clip: of long clips the key frames, which cost no decoding."""
        if self.frame_count is None or self.frame_count > WHOLE_CLIP_FRAMES:
            found = self._key_frames(count)
            if len(found) >= min(FEWEST_SAMPLES, count):
                return found
        return self._evenly(count)

    def _evenly(self, count: int) -> list[Frame]:
        """By decoding from the beginning, converting only what is kept."""
        step = max(1, min(self.frame_count or WHOLE_CLIP_FRAMES, WHOLE_CLIP_FRAMES) // count)
        frames: list[Frame] = []
        with _told(self.path), open_container(self.path) as container:
            stream = video_stream(container, self.path)
            stream.thread_type = "AUTO"
            for index, picture in enumerate(decoded(container, stream)):
                if index % step == 0:
                    frame = self._frame(picture, frames[-1].pts if frames else None)
                    frames.append(replace(frame, number=index))
                    if len(frames) == count:
                        break
        return frames

    def _key_frames(self, count: int) -> list[Frame]:
        found: dict[int, Frame] = {}
        with _told(self.path), open_container(self.path) as container:
            stream = video_stream(container, self.path)
            if not stream.duration:
                return []
            start = stream.start_time or 0
            for target in np.linspace(start, start + stream.duration, count, endpoint=False):
                try:
                    container.seek(int(target), stream=stream)
                    picture = next(decoded(container, stream), None)
                except av.error.FFmpegError:
                    return []  # a file that cannot be sought is decoded from its beginning instead
                if picture is not None and picture.pts is not None and picture.pts not in found:
                    found[picture.pts] = self._frame(picture, None)
        return [found[pts] for pts in sorted(found)]

    def _frame(self, picture: av.VideoFrame, last: int | None) -> Frame:
        pts = picture.pts
        if pts is None:  # raw streams carry no time
            tick = max(1, round(1 / (self.rate * self.time_base)))
            pts = 0 if last is None else last + tick
        return Frame(upright_rgb(picture), pts, self.time_base)


def open_container(path: Path) -> Any:
    """An opened media file of PyAV, to be closed by the caller. Raises InputError."""
    try:
        if path.stat().st_size == 0:
            raise InputError(f"{path}: the file is empty (0 bytes); copy it again")
        return open_media(path)
    except av.error.FFmpegError as error:
        raise InputError(f"{path}: not a readable video ({error.strerror}); give mp4, mov, mkv or webm") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from error


def video_stream(container: Any, path: Path) -> Any:
    """The first stream that is a video and no cover picture. Raises InputError without one."""
    attached = getattr(av.stream.Disposition, "attached_pic", 0)
    for stream in container.streams.video:
        if stream.disposition & attached:
            continue
        if stream.codec_context is None:
            raise InputError(f"{path}: its video is of a kind that cannot be decoded here; convert it to H.264 in mp4")
        return stream
    raise InputError(f"{path}: there is no video in this file (sound only?); give a file that shows a face")


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turns what the decoder refuses into one line."""
    try:
        yield
    except av.error.FFmpegError as error:
        raise InputError(f"{path}: cannot be read any further ({error.strerror}); copy or convert it again") from error


def _expected_frames(stream: Any, rate: Fraction) -> int | None:
    """By duration where it is known: the stream's own count includes what an edit list cuts away."""
    return round(stream.duration * stream.time_base * rate) if stream.duration else stream.frames or None


def decoded(container: Any, stream: Any) -> Iterator[av.VideoFrame]:
    """The stream's pictures; a packet that cannot be decoded is passed over, the next ones still count."""
    for packet in container.demux(stream):
        try:
            yield from packet.decode()
        except av.error.InvalidDataError:
            continue


def upright_rgb(picture: av.VideoFrame) -> NDArray[np.uint8]:
    """[H, W, 3] sRGB, at most LONGEST_SIDE, turned by the display matrix: phones film sideways and say so there."""
    _guess_colours(picture)
    scale = min(1.0, LONGEST_SIDE / max(picture.width, picture.height))
    if scale < 1:
        picture = picture.reformat(max(1, round(picture.width * scale)), max(1, round(picture.height * scale)), "rgb24")
    rgb = np.asarray(picture.to_ndarray(format="rgb24"), np.uint8)
    quarter_turns = round(picture.rotation / 90) % 4  # counter-clockwise, as np.rot90 turns
    return np.ascontiguousarray(np.rot90(rgb, quarter_turns)) if quarter_turns else rgb


def _guess_colours(picture: av.VideoFrame) -> None:
    """Where it is not said how luma and chroma become RGB, large pictures are BT.709 to players; unsaid it is BT.601."""
    if picture.colorspace == _UNSAID and not picture.format.is_rgb and (picture.width >= 1280 or picture.height > 576):
        picture.colorspace = Colorspace.ITU709
