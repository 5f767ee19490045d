"""A video file played in real time by its timestamps; what comes too late is decoded and passed over."""

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Any

import av

from ...models.mediafile import decoded, duration_of, pixel_aspect_of, rate_of
from ...models.videopicture import upright_rgb
from ..errors import InputError
from ..files.frames import Frame
from ..files.video import WITHOUT_PTS, open_container, video_stream
from .source import Kind, SourceLost, TimedFrame
from .transport import Playhead

MOST_AT_ONCE = 8
"""After so many frames passed over in one read the clock slips instead: it would never catch up."""
_EARLY_SECS = 1e-4
_WHEN_WHOLE = "Open it again when it is whole."
_FURTHER_SECS = 1.0
"""So much further back a file is sent that was sent back and came out behind; twice as far each time."""


class VideoPlayer:
    """Looks like a camera with buttons. Raises InputError when the file is no video."""

    kind: Kind = "video"
    rejected = 0

    def __init__(self, path: Path, clock: Callable[[], float] = time.perf_counter, name: str = "") -> None:
        """``name``: what people call it; the file's own unless given."""
        self.name = name or path.name
        self._path, self._clock = path, clock
        self.drops = 0
        self._open()
        self.transport = Playhead(self._told_secs, self._frame_secs, clock=clock)
        self._jumps = self.transport.jumps

    def read(self, timeout: float) -> Frame | None:
        """The frame that is due now; None before it, and while paused. Raises SourceLost when it breaks off."""
        try:
            found = self._due()
            if found is None and timeout > 0:
                self.transport.wait(min(timeout, self._until_next()))
                found = self._due()
            return found
        except av.error.FFmpegError as error:
            message = f"{self.name} cannot be read any further ({error.strerror})."
            raise SourceLost(message, "Check that the disk is still there, and open the file again.", False) from error
        except InputError as error:  # it was opened anew, and is no longer what it was
            raise SourceLost(f"{error}.", _WHEN_WHOLE, False) from error

    def close(self) -> None:
        """Let go of the file."""
        self._container.close()

    def _open(self) -> None:
        self._container = open_container(self._path)
        self._stream: Any = video_stream(self._container, self._path)
        self._stream.thread_type = "AUTO"
        self._tick = self._stream.time_base or Fraction(1, 1000)
        self._start = self._stream.start_time or 0
        self._pixel_aspect = pixel_aspect_of(self._stream)
        self._frame_secs = 1 / float(rate_of(self._stream))
        told = duration_of(self._container, self._stream)
        self._told_secs = float(told) if told is not None and told > 0 else None
        self._untold = self._container.format.name in WITHOUT_PTS
        self._late: int | None = None
        self._pictures: Iterator[av.VideoFrame] = decoded(self._container, self._stream)
        self._next: tuple[float, av.VideoFrame] | None = None
        self._last_secs = -self._frame_secs

    def _due(self) -> Frame | None:
        position = self.transport.position
        if self.transport.jumps != self._jumps:
            self._jumps = self.transport.jumps
            return self._at(position)
        chosen = None
        for _ in range(MOST_AT_ONCE):
            ahead = self._peek()
            if ahead is None:
                self._learn()
                if chosen is None and position >= self._last_secs + self._frame_secs - _EARLY_SECS:
                    self.transport.end()
                break
            first = self._last_secs < 0  # shown though paused before it was open: nothing is there to look at yet
            if not (first or self.transport.playing) or ahead[0] > position + _EARLY_SECS:
                break
            self.drops += chosen is not None
            chosen = self._take(ahead)
        else:
            self.transport.slip(self._last_secs)
        return self._frame(chosen) if chosen else None

    def _at(self, position: float) -> Frame:
        """The frame that is shown at a position gone to, where times are rounded to the file's ticks; decoded from the
        key frame before it. Raises SourceLost where there is none any more."""
        self._go_before(position)
        found = None
        latest = self._latest(position)
        while (ahead := self._peek()) is not None and (found is None or ahead[0] <= latest):
            found = self._take(ahead)
        if found is None:  # not even after it was opened anew
            raise SourceLost(f"{self.name} holds no picture that can be read.", _WHEN_WHOLE, False)
        if ahead is None:
            self._learn()
        return self._frame(found)

    def _go_before(self, position: float) -> None:
        """Goes on decoding at or before a position.

        Transport streams and FLV come out behind where they are sent: they are sent further and further back, and
        files that cannot be sought, or do not tell times, are decoded from their beginning.
        """
        latest = self._latest(position)
        target, back = position, _FURTHER_SECS
        while self._sought(target):
            ahead = self._peek()
            if ahead is not None and ahead[1].pts is not None and ahead[0] <= latest:
                return
            if target <= 0:
                break
            target, back = position - back, 2 * back
        with suppress(av.error.FFmpegError):
            self._container.close()
        self._open()
        if self._told_secs is not None:  # it may have been written anew
            self.transport.lasts(self._told_secs)

    def _learn(self) -> None:
        """At the end: how long the file is, where it did not tell."""
        if self.transport.duration == float("inf") and self._last_secs >= 0:
            self.transport.lasts(self._last_secs + self._frame_secs)

    def _latest(self, position: float) -> float:
        """What a position is as told in ticks; one of AVI is as long as a frame."""
        return position + min(float(self._tick), self._frame_secs / 2) + _EARLY_SECS

    def _sought(self, position: float) -> bool:
        """Whether the file goes there, or to where its index takes it for."""
        self._next = None
        try:
            target = self._start + int(max(0.0, position) / float(self._tick))
            self._container.seek(target, stream=self._stream)
        except av.error.FFmpegError:
            return False
        self._pictures = decoded(self._container, self._stream)
        return True

    def _peek(self) -> tuple[float, av.VideoFrame] | None:
        """The next frame and its time from the beginning, still unread; None at the end."""
        if self._next is None and (picture := next(self._pictures, None)) is not None:
            if self._untold:
                picture.pts = self._told(picture.dts)
            pts = picture.pts
            seconds = self._last_secs + self._frame_secs if pts is None else float((pts - self._start) * self._tick)
            self._next = (seconds, picture)
        return self._next

    def _told(self, dts: int | None) -> int | None:
        """When a picture is shown that tells only when it is decoded: as much earlier as the first one was."""
        if dts is None:
            return None
        late = self._late if self._late is not None else int(dts - self._start)
        self._late = late
        return dts - late

    def _take(self, ahead: tuple[float, av.VideoFrame]) -> av.VideoFrame:
        self._last_secs, self._next = ahead[0], None
        return ahead[1]

    def _frame(self, picture: av.VideoFrame) -> TimedFrame:
        pts = picture.pts if picture.pts is not None else round(self._last_secs / self._tick)
        return TimedFrame(upright_rgb(picture, self._pixel_aspect), pts, self._tick, delivered=self._clock())

    def _until_next(self) -> float:
        if not self.transport.playing:
            return float("inf")
        due = self._next[0] if self._next else self._last_secs + self._frame_secs
        return max(0.0, due - self.transport.position)
