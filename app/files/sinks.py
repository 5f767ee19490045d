"""Results: video files and folders of PNGs, which carry a partial name until they are whole."""

import errno
import io
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import av
from av.video.frame import PictureType
from av.video.reformatter import ColorRange, Colorspace, VideoReformatter

from ...models.mediafile import open_media
from ...models.wholefile import behind_links, marked, write_whole
from ...render.arrays import Image
from ..errors import OutputError, UsageError
from .audio import AudioCopy
from .claim import open_claimed
from .recipes import KEY

VIDEO_SUFFIXES = (".mp4", ".mov", ".webm")
FRAME_NAME = re.compile(r"frame_\d{6,}\.png")
"""Of the pictures in a folder of results."""
_ALPHA_CODECS = {".mov": ("prores_ks", "yuva444p10le"), ".webm": ("libvpx-vp9", "yuva420p")}
_OPTIONS = {
    # No B-frames: every packet leaves in the order it is shown, so a killed run loses at most one fragment.
    "libx264": {"preset": "veryfast", "crf": "18", "bf": "0"},
    "mpeg4": {"qscale": "3"},
    "libvpx-vp9": {"deadline": "realtime", "cpu-used": "8", "crf": "24", "b": "0", "row-mt": "1"},
    "prores_ks": {"profile": "4444"},
}
FRAGMENT_SECS = 1
"""A key frame begins each fragment: after this time, as rates are claims, and live pictures come when they come."""
_MOST_BETWEEN = 600
"""Pictures from key frame to key frame, which MPEG-4 part 2 takes no more of."""
_BT709 = 1
"""The number of matrix, primaries and transfer in H.273: all of these encoders can write it, and players assume it of
large pictures that say nothing."""


class Sound(Protocol):
    """What sounds beside the pictures of a video; its track is in the container before the first picture."""

    def copy_until(self, seconds: float) -> None:
        """Write what sounds before this time."""
        ...

    def close(self, whole: bool) -> None:
        """Write the rest when ``whole``, and the end of the track."""
        ...


class Sink(Protocol):
    """Where pictures go, in order of presentation."""

    partial: Path
    """The name until everything is written."""

    def has(self, index: int) -> bool:
        """Whether an earlier run already wrote the frame with this index."""
        ...

    def write(self, index: int, image: Image, pts: int) -> None:
        """One picture [H, W, 3] RGB, or [H, W, 4] with straight alpha. Raises OutputError."""
        ...

    def close(self, whole: bool) -> None:
        """Finish; ``whole`` gives the result its final name. Raises OutputError."""
        ...


def partial_name(path: Path) -> Path:
    """The name of an unfinished result: it keeps its suffix, so that players open it."""
    return marked(path, "partial")


class VideoSink:
    """H.264 in fragments (or VP9, ProRes with alpha), timestamps as given, sound copied from the driver."""

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        time_base: Fraction,
        rate: Fraction,
        transparent: bool,
        audio: Path | Callable[[Any], Sound] | None,
        recipe: str = "",
    ) -> None:
        """``audio`` names a file whose first sound track is copied beside the pictures, or adds a track of its own to
        the opened container; ``recipe`` goes into the file (see ``recipes``). Raises OutputError, and TakenError where
        another run is writing this result."""
        path = behind_links(path)
        self.path, self.partial = path, partial_name(path)
        suffix = path.suffix.lower()
        codec, pixels = video_codec(suffix, transparent)
        with _told(self.partial):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = _WatchedFile(self.partial)
            self._container = av.open(self._file, "w", format=suffix[1:], options=_container_options(suffix, time_base))
            if recipe:
                self._container.metadata[KEY] = recipe
            stream: Any = self._container.add_stream(codec, rate=rate, options=_OPTIONS.get(codec, {}))
        stream.width, stream.height, stream.pix_fmt = *size, pixels
        stream.time_base = stream.codec_context.time_base = time_base
        stream.codec_context.gop_size = _MOST_BETWEEN
        stream.codec_context.thread_count = min(4, os.cpu_count() or 1)
        _name_colours(stream.codec_context)
        self._stream, self._time_base, self._count = stream, time_base, 0
        self._key_seconds: Fraction | None = None
        self._pixels, self._reformatter = pixels, VideoReformatter()
        self._audio: Sound | None = None
        if audio is not None:
            self._audio = AudioCopy(audio, self._container) if isinstance(audio, Path) else audio(self._container)

    def has(self, index: int) -> bool:
        """Always False: a stream of frames is written from its beginning."""
        return False

    def write(self, index: int, image: Image, pts: int) -> None:
        """Encode one picture and the sound up to it."""
        frame = self._converted(image)
        frame.pts, frame.time_base = pts, self._time_base
        seconds = pts * self._time_base
        if self._key_seconds is None or seconds >= self._key_seconds + FRAGMENT_SECS:
            self._key_seconds, frame.pict_type = seconds, PictureType.I
        with _told(self.partial), self._file.checked():
            for packet in self._stream.encode(frame):
                self._container.mux(packet)
            if self._audio:
                self._audio.copy_until(float(seconds))
        self._count += 1

    def close(self, whole: bool) -> None:
        """Flush. Sound beyond the last picture is copied only when the result is whole."""
        with _told(self.partial):
            try:
                with self._file.checked():
                    try:
                        if self._count:
                            for packet in self._stream.encode():
                                self._container.mux(packet)
                        if self._audio:
                            self._audio.close(whole)
                    finally:
                        self._container.close()
                if whole:
                    self._name()
            finally:
                self._file.close()

    def _name(self) -> None:
        """What is on the disk gets its final name while it is still this run's: nobody begins another in between."""
        os.fsync(self._file.fileno())
        if sys.platform == "win32":  # which names only what is closed
            self._file.close()
        self.partial.replace(self.path)

    def _converted(self, image: Image) -> av.VideoFrame:
        """Luma and chroma by the matrix that the file names, in limited range."""
        return self._reformatter.reformat(
            av.VideoFrame.from_ndarray(image, format="rgba" if image.shape[2] == 4 else "rgb24"),
            format=self._pixels,
            dst_colorspace=Colorspace.ITU709,
            src_color_range=ColorRange.JPEG,
            dst_color_range=ColorRange.MPEG,
        )


class _WatchedFile(io.FileIO):
    """This run's alone. Remembers what went wrong: FFmpeg forgets it when it happens to the last bytes, and names it
    otherwise later."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, "w", opener=open_claimed)
        self._trouble: OSError | None = None

    def write(self, data: Any, /) -> int:
        """All of the bytes: a disk that is nearly full takes a part."""
        left = memoryview(data)
        try:
            while len(left):
                left = left[super().write(left) :]
        except OSError as error:
            self._trouble = self._trouble or error
            raise
        return len(data)

    @contextmanager
    def checked(self) -> Iterator[None]:
        """Raises OSError where anything is missing, in the place of what FFmpeg raises for it."""
        try:
            yield
        except (OSError, av.error.FFmpegError) as error:
            if self._trouble is not None:
                raise self._trouble from error
            raise
        if self._trouble is not None:
            raise self._trouble


class FolderSink:
    """PNGs with alpha or without, and their times in ``times.csv``, which appears when the folder is whole."""

    def __init__(
        self, path: Path, time_base: Fraction, resume: bool, signed: Callable[[bytes], bytes] | None = None
    ) -> None:
        """``signed`` puts credentials into the bytes of a PNG. Raises OutputError when the folder cannot be made."""
        self.path = self.partial = path
        self._signed = signed
        self._time_base, self._resume = time_base, resume
        self._times: list[str] = []
        with _told(path):
            path.mkdir(parents=True, exist_ok=True)
            (path / TIMES_FILE).unlink(missing_ok=True)

    def has(self, index: int) -> bool:
        """Whether this frame is there from an earlier run that ``--resume`` continues."""
        return self._resume and self._file(index).is_file()

    def write(self, index: int, image: Image, pts: int) -> None:
        """One PNG under its final name only when all its bytes are there. An image of no pixels only notes the time."""
        import cv2

        self._times.append(f"{self._file(index).name},{float(pts * self._time_base):.9f}")
        if image.size == 0:
            return
        order = cv2.COLOR_RGBA2BGRA if image.shape[2] == 4 else cv2.COLOR_RGB2BGR
        _, data = cv2.imencode(".png", cv2.cvtColor(image, order), [cv2.IMWRITE_PNG_COMPRESSION, 1])
        with _told(self.path):
            png = data.tobytes()
            write_whole(self._file(index), [self._signed(png) if self._signed else png])

    def close(self, whole: bool) -> None:
        """Write the times when the folder is whole."""
        if whole:
            with _told(self.path):
                text = "file,seconds\n" + "\n".join(self._times) + "\n"
                write_whole(self.path / TIMES_FILE, [text.encode()])

    def _file(self, index: int) -> Path:
        return self.path / f"frame_{index:06d}.png"


TIMES_FILE = "times.csv"


def is_whole(path: Path) -> bool:
    """Whether an earlier run finished this result, and all that it wrote is still there."""
    if path.suffix.lower() in VIDEO_SUFFIXES:
        return path.is_file()
    try:
        lines = (path / TIMES_FILE).read_text("utf-8", "replace").splitlines()
    except OSError:
        return False
    names = (line.partition(",")[0] for line in lines)
    return all((path / name).is_file() for name in names if FRAME_NAME.fullmatch(name))


def video_codec(suffix: str, transparent: bool) -> tuple[str, str]:
    """Encoder and pixel format for a suffix. Raises UsageError where alpha is impossible, OutputError if none is."""
    if suffix not in VIDEO_SUFFIXES:
        raise UsageError(f"cannot write {suffix!r} files; name the result .mp4, .mov, .webm, or a folder for PNGs")
    if transparent:
        if suffix not in _ALPHA_CODECS:
            raise UsageError(f"{suffix} cannot be transparent; name the result .mov, .webm, or a folder for PNGs")
        return _ALPHA_CODECS[suffix]
    wanted = ("libvpx-vp9",) if suffix == ".webm" else ("libx264", "libopenh264", "mpeg4")
    for codec in wanted:
        if has_encoder(codec):
            return codec, "yuv420p"
    raise OutputError(f"this PyAV has no encoder for {suffix} ({', '.join(wanted)}); reinstall it: pip install -U av")


def has_encoder(codec: str) -> bool:
    """Whether the installed PyAV can encode with ``codec``."""
    try:
        av.codec.Codec(codec, "w")
    except (av.codec.codec.UnknownCodecError, ValueError):
        return False
    return True


def _name_colours(codec: Any) -> None:
    """Says how the pictures are to be turned into RGB again: unsaid, players guess, by the size of the picture."""
    codec.colorspace = codec.color_primaries = codec.color_trc = _BT709
    codec.color_range = ColorRange.MPEG


def _container_options(suffix: str, time_base: Fraction) -> dict[str, str]:
    """A file that plays however it ends: fragments, flushed as they fill.

    The edit list that keeps a late first picture late counts in the movie's time scale: that one is the stream's.
    """
    if suffix == ".webm":
        return {"flush_packets": "1"}
    return {
        # without FFmpeg's table of fragments at the end: what signs a file moves them, and the table would point astray
        "movflags": "frag_keyframe+delay_moov+default_base_moof+skip_trailer",
        "movie_timescale": str(time_base.denominator),
        "flush_packets": "1",
    }


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turns what the system or the encoder refuses into one line that says what is left."""
    try:
        yield
    except (OSError, av.error.FFmpegError) as error:
        frames = _frames_in(path)
        left = f"; the {frames} frames written so far are in {path}" if frames else ""
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            raise OutputError(f"{path}: no space left{left}; free some space and run again") from error
        raise OutputError(
            f"{path}: cannot be written ({error.strerror}){left}; check the path and its permissions"
        ) from error


def _frames_in(path: Path) -> int:
    """How many frames of an unfinished result can be had from it."""
    if path.is_dir():
        return sum(FRAME_NAME.fullmatch(file.name) is not None for file in path.iterdir())
    count = 0
    try:
        with open_media(path) as container:
            for packet in container.demux(video=0):
                count += packet.size > 0 and not packet.is_corrupt
    except (OSError, av.error.FFmpegError, IndexError, ValueError):
        return count  # it may end anywhere
    return count
