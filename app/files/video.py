"""Reading a video file: upright frames with the file's own timestamps."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np

from ...models.driver.face import LEAST_SIDE, MOST_SIDE
from ...models.mediafile import decoded, duration_of, main_video, open_media, pixel_aspect_of, rate_of, start_of
from ...models.videopicture import upright_rgb
from ..errors import InputError
from .audio import sound_track
from .crop import WHOLE, Crop
from .frames import Frame, spread

WITHOUT_PTS = ("avi",)
"""Containers that say only when pictures are decoded, not when they are shown: of pictures that are stored in another
order than they are shown in, what the decoder calls their time is that of others."""
WHOLE_CLIP_FRAMES = 1500
"""Up to this many frames, sampling decodes everything; beyond, it seeks."""
FEWEST_SAMPLES = 12


class VideoFile:
    """A video stream of a file; its times are counted from where the file's clock begins.

    Raises InputError when the file is missing, empty, not a video, or cannot be read.
    """

    def __init__(self, path: Path, crop: Crop = WHOLE) -> None:
        """``crop``: the part of its pictures that frames show."""
        self.path = path
        self._crop = crop
        with open_container(path) as container:
            stream = video_stream(container, path)
            self.time_base: Fraction = stream.time_base or Fraction(1, 1000)
            self.rate = rate_of(stream)
            self.frame_count: int | None = _expected_frames(container, stream, self.rate)
            self.has_audio = sound_track(container) is not None
            self.has_unreadable_audio = bool(container.streams.audio) and not self.has_audio
            self._start = round(start_of(container) / self.time_base)
            self._pixel_aspect = pixel_aspect_of(stream)
            self._untold = container.format.name in WITHOUT_PTS
        self.left_out = 0
        """Pictures of the last reading that were not shown later than the one before, and were passed over."""
        first = next(self.frames())
        self.size = (first.rgb.shape[1], first.rgb.shape[0])
        check_sides(path, self.size, crop)

    def frames(self) -> Iterator[Frame]:
        """All frames in order of presentation; damaged packets are passed over. Raises InputError without any."""
        last: int | None = None
        for picture, last in self._timed():
            yield self._frame(picture, last)
        if last is None:
            raise InputError(f"{self.path}: the clip holds no picture (zero length?); give one with at least one frame")

    def _timed(self) -> Iterator[tuple[av.VideoFrame, int]]:
        """The pictures that are shown, each with its timestamp, which rises: a repeated one is the same instant and
        cannot be shown twice."""
        last: int | None = None
        self.left_out = 0
        with _told(self.path), open_container(self.path) as container:
            stream = video_stream(container, self.path)
            stream.thread_type = "AUTO"
            late = 0
            for picture in decoded(container, stream):
                if self._untold:
                    late = _lateness(picture) if last is None else late
                    picture.pts = None if picture.dts is None else picture.dts - late
                pts = self._pts(picture, last)
                if last is None or pts > last:
                    last = pts
                    yield picture, pts
                else:
                    self.left_out += 1

    def samples(self, count: int) -> list[Frame]:
        """Up to ``count`` frames spread over the clip: of long clips the key frames, which cost no decoding."""
        if self.frame_count is None or self.frame_count > WHOLE_CLIP_FRAMES:
            found = self._key_frames(count)
            if len(found) >= min(FEWEST_SAMPLES, count):
                return found
        return self._evenly(count)

    def _evenly(self, count: int) -> list[Frame]:
        """By decoding from the beginning, converting only what is kept."""
        expected = min(self.frame_count or WHOLE_CLIP_FRAMES, WHOLE_CLIP_FRAMES)
        frames, decoded_count = self._numbered(spread(expected, count))
        if len(frames) < min(FEWEST_SAMPLES, count, decoded_count):  # fewer came than the file says, or it says nothing
            frames, _ = self._numbered(spread(decoded_count, count))
        return frames

    def _numbered(self, numbers: list[int]) -> tuple[list[Frame], int]:
        """The frames of these numbers as far as there are such, and how many were decoded for them."""
        frames: list[Frame] = []
        wanted, index = set(numbers), -1
        for index, (picture, pts) in enumerate(self._timed()):
            if index in wanted:
                frames.append(replace(self._frame(picture, pts), number=index))
                if len(frames) == len(wanted):
                    break
        return frames, index + 1

    def _key_frames(self, count: int) -> list[Frame]:
        found: dict[int, Frame] = {}
        with _told(self.path), open_container(self.path) as container:
            stream = video_stream(container, self.path)
            seconds = duration_of(container, stream)
            if not seconds:
                return []
            start = stream.start_time or 0
            for target in np.linspace(start, start + float(seconds / self.time_base), count, endpoint=False):
                try:
                    container.seek(int(target), stream=stream)
                    picture = next(decoded(container, stream), None)
                except av.error.FFmpegError:
                    return []  # a file that cannot be sought is decoded from its beginning instead
                if picture is not None and picture.pts is not None and picture.pts not in found:
                    found[picture.pts] = self._frame(picture, self._pts(picture, None))
        return [found[pts] for pts in sorted(found)]

    def _pts(self, picture: av.VideoFrame, last: int | None) -> int:
        if picture.pts is not None:
            return picture.pts - self._start
        tick = max(1, round(1 / (self.rate * self.time_base)))  # raw streams carry no time
        return 0 if last is None else last + tick

    def _frame(self, picture: av.VideoFrame, pts: int) -> Frame:
        return Frame(self._crop.of(upright_rgb(picture, self._pixel_aspect)), pts, self.time_base)


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
    """The largest stream that is a video and no cover picture. Raises InputError without one."""
    stream = main_video(container)
    if stream is None:
        raise InputError(f"{path}: there is no video in this file (sound only?); give a file that shows a face")
    if stream.codec_context is None:
        raise InputError(f"{path}: its video is of a kind that cannot be decoded here; convert it to H.264 in mp4")
    return stream


def check_sides(path: Path, size: tuple[int, int], crop: Crop = WHOLE) -> None:
    """Raises InputError for pictures in which no face can be looked for: ``size`` is width and height of what ``crop``
    leaves of them."""
    if crop != WHOLE and min(size) < LEAST_SIDE:
        raise InputError(
            f"{path}: --crop {crop} leaves {size[0]}x{size[1]} pixels; give a part of at least {LEAST_SIDE} to a side"
        )
    if not all(LEAST_SIDE <= side <= MOST_SIDE for side in size):
        raise InputError(
            f"{path}: {size[0]}x{size[1]} pixels; give pictures with sides from {LEAST_SIDE} to {MOST_SIDE} pixels"
        )


def _lateness(picture: av.VideoFrame) -> int:
    """By how much the first picture comes out of the decoder later than it went in, which is when it is shown."""
    return 0 if picture.pts is None or picture.dts is None else picture.dts - picture.pts


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turns what the decoder refuses into one line."""
    try:
        yield
    except av.error.FFmpegError as error:
        raise InputError(f"{path}: cannot be read any further ({error.strerror}); copy or convert it again") from error


def _expected_frames(container: Any, stream: Any, rate: Fraction) -> int | None:
    """By duration where it is known: the stream's own count includes what an edit list cuts away."""
    seconds = duration_of(container, stream)
    return round(seconds * rate) if seconds else stream.frames or None
