"""The driver's sound, copied packet by packet; re-encoded only where the new container refuses it."""

from fractions import Fraction
from pathlib import Path
from typing import Any

import av

from ..models.mediafile import open_media

_COPIED = {
    "mp4": {"aac", "mp3", "mp3float", "ac3", "eac3", "alac", "opus", "libopus", "flac", "mp2", "mp2float"},
    "mov": {"aac", "mp3", "mp3float", "ac3", "alac", "pcm_s16le", "pcm_s24le"},
    "webm": {"opus", "libopus", "vorbis", "libvorbis"},
}


class AudioCopy:
    """The first sound track of a file; without one, does nothing."""

    def __init__(self, source: Path, container: Any) -> None:
        """Adds a stream to ``container``, which must not have been written to."""
        self._source: Any = open_media(source)
        self._container = container
        self._encoder: Any = None
        self._packets: Any = iter(())
        self._next: Any = None
        if not self._source.streams.audio:
            return
        track = self._source.streams.audio[0]
        if track.codec_context.name in _COPIED.get(container.format.name.split(",")[0], ()):
            self._stream = container.add_stream_from_template(track)
        else:
            codec = "libopus" if container.format.name == "webm" else "aac"
            self._encoder = self._stream = container.add_stream(codec, rate=48000)
            self._resampler = av.AudioResampler(format=self._encoder.codec_context.format, layout="stereo", rate=48000)
        self._packets = self._source.demux(track)

    def copy_until(self, seconds: float) -> None:
        """Everything that sounds before this time."""
        while True:
            if self._next is None:
                self._next = next(self._packets, None)
                if self._next is None or self._next.dts is None:  # demux ends with an empty packet
                    self._next, self._packets = None, iter(())
                    return
            if float(self._next.dts * Fraction(self._next.time_base)) > seconds:
                return
            self._write(self._next)
            self._next = None

    def close(self, whole: bool) -> None:
        """The rest of the sound when ``whole``, and the end of the stream."""
        if whole:
            self.copy_until(float("inf"))
        if self._encoder:
            self._mux_encoded([*self._resampler.resample(None), None])
        self._source.close()

    def _write(self, packet: Any) -> None:
        if self._encoder is None:
            packet.stream = self._stream
            self._container.mux(packet)
            return
        for frame in packet.decode():
            self._mux_encoded(self._resampler.resample(frame))

    def _mux_encoded(self, frames: list[Any]) -> None:
        for frame in frames:
            for packet in self._encoder.encode(frame):
                self._container.mux(packet)
