"""Sound as people's files have it: without headers, damaged, cut, changing, or of no known kind."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from gemheads.app.files.sinks import VideoSink
from gemheads.app.files.video import VideoFile

from ..conftest import Clip, make_sound_unknown

BASE = Fraction(1, 30000)
SECOND = tuple(range(0, 30030, 1001))
Copied = Callable[[Path, str], Path]


@pytest.fixture
def copied(tmp_path: Path) -> Copied:
    """The sound of a file beside a second of black, in a video with this suffix."""

    def copy(source: Path, suffix: str) -> Path:
        sink = VideoSink(tmp_path / f"out{suffix}", (96, 64), BASE, Fraction(30), False, source)
        for index, instant in enumerate(SECOND):
            sink.write(index, np.zeros((64, 96, 3), np.uint8), instant)
        sink.close(True)
        return sink.path

    return copy


def heard(path: Path) -> tuple[float, float]:
    """When the sound begins and how long it lasts, in seconds."""
    with av.open(str(path)) as container:
        frames = list(container.decode(audio=0))
    return frames[0].time or 0.0, sum(frame.samples / frame.sample_rate for frame in frames)


def tone(layout: str = "mono", rate: int = 48000) -> av.AudioFrame:
    """A second of 440 Hz."""
    wave = 0.5 * np.sin(np.arange(rate) * (880 * np.pi / rate)).astype(np.float32)
    channels = len(av.AudioLayout(layout).channels)
    frame = av.AudioFrame.from_ndarray(np.repeat(wave[None], channels, 0), format="fltp", layout=layout)
    frame.sample_rate, frame.pts, frame.time_base = rate, 0, Fraction(1, rate)
    return frame


def write_tone(path: Path, codec: str, layout: str = "mono", rate: int = 48000) -> Path:
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=rate, layout=layout)
        container.mux(stream.encode(tone(layout, rate)))
        container.mux(stream.encode())
    return path


@pytest.mark.parametrize("suffix", [".mp4", ".mov", ".webm"])
def test_sound_of_a_transport_stream_is_taken_from_where_its_clock_begins(
    make_clip: Clip, copied: Copied, suffix: str
) -> None:
    clip = make_clip("clip.ts", tuple(30000 + pts for pts in SECOND), sound=True)
    with av.open(str(clip)) as container:
        assert not container.streams.audio[0].codec_context.extradata
    begins, secs = heard(copied(clip, suffix))
    assert begins == pytest.approx(0, abs=0.03)
    assert secs == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("suffix", [".mp4", ".webm"])
def test_damaged_packets_of_sound_are_passed_over(make_clip: Clip, copied: Copied, suffix: str) -> None:
    clip = make_clip(pts=SECOND, sound=True)
    with av.open(str(clip)) as container:
        places = [(packet.pos, packet.size) for packet in container.demux(audio=0)][10:13]
    data = bytearray(clip.read_bytes())
    for place, size in places:
        data[place : place + size] = b"\xff" * size
    clip.write_bytes(data)
    result = copied(clip, suffix)
    with av.open(str(result)) as container:
        assert len(list(container.decode(video=0))) == len(SECOND)
    if suffix == ".webm":
        assert heard(result)[1] == pytest.approx(1 - 3 * 1024 / 48000, abs=0.1)


def test_a_recording_whose_clock_goes_back_keeps_the_sound_until_there(make_clip: Clip, copied: Copied) -> None:
    clip = make_clip("clip.ts", SECOND, sound=True)
    clip.write_bytes(clip.read_bytes() * 2)
    for suffix in (".mp4", ".webm"):
        assert heard(copied(clip, suffix))[1] == pytest.approx(1, abs=0.1)


def test_sound_that_changes_from_stereo_to_surround_goes_on(tmp_path: Path, copied: Copied) -> None:
    parts = [write_tone(tmp_path / f"{layout}.aac", "aac", layout) for layout in ("stereo", "5.1")]
    both = tmp_path / "both.aac"
    both.write_bytes(b"".join(part.read_bytes() for part in parts))
    assert heard(copied(both, ".webm"))[1] == pytest.approx(2, abs=0.1)


def test_sound_that_was_cut_away_in_front_does_not_come_back(tmp_path: Path, copied: Copied) -> None:
    whole, cut = write_tone(tmp_path / "whole.mp4", "aac"), tmp_path / "cut.mp4"
    with av.open(str(whole)) as source, av.open(str(cut), "w") as container:
        stream = container.add_stream_from_template(source.streams.audio[0])
        for packet in source.demux(audio=0):
            if packet.size:
                packet.stream = stream
                packet.pts, packet.dts = packet.pts - 24000, packet.dts - 24000
                container.mux(packet)
    with av.open(str(cut)) as container:
        assert sum(packet.is_discard for packet in container.demux(audio=0)) > 20
    result = copied(cut, ".mp4")
    with av.open(str(result)) as container:
        first = next(container.demux(audio=0))
    assert -2 * 1024 / 48000 < first.pts * first.time_base < 0  # with one packet from which the decoder starts
    assert heard(result)[1] == pytest.approx(0.5, abs=0.06)


@pytest.mark.skipif("libmp3lame" not in av.codecs_available, reason="this PyAV has no encoder for MP3")
def test_slow_mp3_which_mp4_refuses_is_encoded_again(tmp_path: Path, copied: Copied) -> None:
    result = copied(write_tone(tmp_path / "slow.mp3", "libmp3lame", rate=11025), ".mp4")
    with av.open(str(result)) as container:
        assert container.streams.audio[0].codec_context.name == "aac"
    assert heard(result)[1] == pytest.approx(1, abs=0.2)


def test_sound_of_no_known_kind_is_no_sound_but_told_apart_from_silence(make_clip: Clip, copied: Copied) -> None:
    clip = make_clip(pts=SECOND, sound=True)
    assert (VideoFile(clip).has_audio, VideoFile(clip).has_unreadable_audio) == (True, False)
    make_sound_unknown(clip)
    assert (VideoFile(clip).has_audio, VideoFile(clip).has_unreadable_audio) == (False, True)
    with av.open(str(copied(clip, ".mp4"))) as container:
        assert not container.streams.audio
