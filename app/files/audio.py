"""The driver's sound, copied packet by packet; re-encoded only where the new container refuses it."""

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import av
from av.bitstream import BitStreamFilterContext

from ...models.mediafile import open_media, start_of

_COPIED = {
    "mp4": {"aac", "mp3", "mp3float", "ac3", "eac3", "alac", "opus", "libopus", "flac", "mp2", "mp2float"},
    "mov": {"aac", "mp3", "mp3float", "ac3", "alac", "pcm_s16le", "pcm_s24le"},
    "webm": {"opus", "libopus", "vorbis", "libvorbis"},
}
_MP3_IN_MP4_HZ = 16000
"""Slower MP3, as old cameras write it, has no place in MP4."""


def sound_track(container: Any) -> Any:
    """The first stream of sound that can be decoded here; None without one."""
    return next((track for track in container.streams.audio if track.codec_context is not None), None)


class AudioCopy:
    """The first sound track of a file that can be decoded; without one, does nothing.

    Damaged packets are passed over: the pictures go on without them.
    """

    def __init__(self, source: Path, container: Any) -> None:
        """Adds a stream to ``container``, which must not have been written to."""
        self._source: Any = open_media(source)
        self._container = container
        self._encoder: Any = None
        self._resampler: Any = None
        self._resampled: Any = None
        """Format, layout and rate of the frames that the resampler takes."""
        self._filter: Any = None
        self._packets: Iterator[Any] = iter(())
        self._next: Any = None
        self._discarded: Any = None
        track = sound_track(self._source)
        if track is None:
            return
        target, codec = container.format.name.split(",")[0], track.codec_context
        slow = codec.name in ("mp3", "mp3float") and codec.sample_rate < _MP3_IN_MP4_HZ
        if codec.name in _COPIED.get(target, ()) and not (target == "mp4" and slow):
            self._stream = container.add_stream_from_template(track)
            if codec.name == "aac" and not codec.extradata:
                # transport streams say in every packet what this container says once
                self._filter = BitStreamFilterContext("aac_adtstoasc", track)
        else:
            self._encoder = self._stream = container.add_stream("libopus" if target == "webm" else "aac", rate=48000)
        self._packets = _rising(self._source, track, strictly=target != "webm")

    def copy_until(self, seconds: float) -> None:
        """Everything that sounds before this time."""
        while True:
            if self._next is None:
                self._next = next(self._packets, None)
            if self._next is None or float(self._next.dts * self._next.time_base) > seconds:
                return
            if self._encoder:
                self._encode(self._next)
            else:
                self._copy(self._next)
            self._next = None

    def close(self, whole: bool) -> None:
        """The rest of the sound when ``whole``, and the end of the stream."""
        if whole:
            self.copy_until(float("inf"))
        if self._encoder:
            self._mux_encoded([*self._rest(), None])
        self._source.close()

    def _copy(self, packet: Any) -> None:
        if packet.is_discard:  # before an edit list begins; a decoder needs only the last of them to begin well
            self._discarded = packet
            return
        for one in (packet,) if self._discarded is None else (self._discarded, packet):
            for filtered in self._filtered(one):
                filtered.stream = self._stream
                self._container.mux(filtered)
        self._discarded = None

    def _filtered(self, packet: Any) -> list[Any]:
        if self._filter is None:
            return [packet]
        try:
            return self._filter.filter(packet)
        except av.error.InvalidDataError:
            return []

    def _encode(self, packet: Any) -> None:
        frames: list[Any] = []
        with suppress(av.error.FFmpegError):
            frames = packet.decode()
        for frame in frames:
            kind = frame.format.name, frame.layout.name, frame.sample_rate
            if kind != self._resampled:  # broadcasts change between stereo and surround
                self._mux_encoded(self._rest())
                sample_format = self._encoder.codec_context.format
                self._resampler = av.AudioResampler(format=sample_format, layout="stereo", rate=48000)
                self._resampled = kind
            self._mux_encoded(self._resampler.resample(frame))

    def _rest(self) -> list[Any]:
        """What the resampler still holds."""
        return self._resampler.resample(None) if self._resampler else []

    def _mux_encoded(self, frames: list[Any]) -> None:
        for frame in frames:
            for packet in self._encoder.encode(frame):
                self._container.mux(packet)


def _rising(container: Any, track: Any, strictly: bool) -> Iterator[Any]:
    """A track's packets from the beginning of the container's clock; those that go back in time are left out.

    Where the file cannot be read any further the sound ends: whoever reads its pictures says so.
    """
    start = round(start_of(container) / track.time_base)
    last: int | None = None
    with suppress(av.error.FFmpegError):
        for packet in container.demux(track):
            if packet.dts is None:  # demux ends with an empty packet
                return
            if last is not None and packet.dts < last + strictly:
                continue
            last = packet.dts
            packet.dts -= start
            if packet.pts is not None:
                packet.pts -= start
            yield packet
