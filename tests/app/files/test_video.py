"""Videos as drivers: times, samples, which way is up, and colours."""

import struct
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from av.video.reformatter import ColorRange, Colorspace
from gemheads.app.errors import InputError
from gemheads.app.files.frames import spread
from gemheads.app.files.sources import open_source
from gemheads.app.files.video import VideoFile
from gemheads.models.videopicture import displayed

from ..clips import grey_clip
from ..conftest import Clip

VARIABLE = (0, 1001, 2500, 2501, 9000)


def test_a_videos_times_are_its_own(make_clip: Clip) -> None:
    source = open_source(str(make_clip(pts=VARIABLE)))
    frames = list(source.frames())
    assert tuple(frame.pts for frame in frames) == VARIABLE
    assert source.time_base == Fraction(1, 30000)
    assert frames[1].seconds == pytest.approx(1001 / 30000)
    assert source.size == (96, 64)
    assert frames[0].rgb.shape == (64, 96, 3)


@pytest.mark.parametrize(("rotation", "bright"), [(90, (True, False)), (180, (False, False)), (270, (False, True))])
def test_a_video_filmed_sideways_stands_upright(make_clip: Clip, rotation: int, bright: tuple[bool, bool]) -> None:
    # The upper left quarter is bright; a quarter turn counter-clockwise takes it to the lower left, and so on.
    source = open_source(str(make_clip(rotation=rotation)))
    rgb = next(source.frames()).rgb
    assert source.size == ((64, 96) if rotation != 180 else (96, 64))
    assert (rgb[-5, 5].mean() > 60, rgb[5, -5].mean() > 60) == bright
    assert rgb[5, 5].mean() < 60


@pytest.mark.parametrize(
    ("matrix", "bright"),
    [
        (((-1, 0), (0, 1)), (0, -1)),  # mirrored
        (((1, 0), (0, -1)), (-1, 0)),  # upside down in a mirror
        (((0, 1), (1, 0)), (0, 0)),  # turned and mirrored
        (((0, -1), (-1, 0)), (-1, -1)),
        (((0, 1), (-1, 0)), (0, -1)),  # a quarter turn clockwise
    ],
)
def test_a_mirrored_picture_is_shown_as_its_maker_saw_it(
    matrix: tuple[tuple[int, int], ...], bright: tuple[int, int]
) -> None:
    stored = np.zeros((4, 6, 3), np.uint8)
    stored[0, 0] = 255
    shown = displayed(stored, np.array(matrix) * 65536)
    assert shown.shape == ((4, 6, 3) if matrix[0][0] else (6, 4, 3))
    assert shown[bright].all()
    assert np.count_nonzero(shown) == 3


def test_a_container_that_says_when_pictures_are_decoded_loses_none(tmp_path: Path) -> None:
    source = open_source(str(grey_clip(tmp_path / "clip.avi")))
    frames = list(source.frames())
    assert [round(float(frame.rgb.mean()) / 8) for frame in frames] == list(range(30))
    assert np.diff([frame.seconds for frame in frames]) == pytest.approx(1 / 25, abs=1e-6)
    assert isinstance(source, VideoFile)
    assert source.left_out == 0


@pytest.mark.parametrize("suffix", [".h264", ".avi"])
def test_samples_have_the_times_that_the_frames_have(tmp_path: Path, suffix: str) -> None:
    """Raw streams carry none, and AVI says when pictures are decoded."""
    source = open_source(str(grey_clip(tmp_path / f"clip{suffix}")))
    frames, samples = list(source.frames()), source.samples(5)
    assert len(samples) == 5
    for sample in samples:
        same = frames[sample.number or 0]
        assert sample.seconds == same.seconds
        np.testing.assert_array_equal(sample.rgb, same.rgb)


def test_pictures_whose_times_do_not_rise_are_counted(make_clip: Clip, tmp_path: Path) -> None:
    part = make_clip("part.ts").read_bytes()
    joined = tmp_path / "joined.ts"
    joined.write_bytes(part + part)
    source = VideoFile(joined)
    assert len(list(source.frames())) == 4
    assert source.left_out == 4


@pytest.mark.parametrize(("size", "matrix"), [((96, 64), Colorspace.ITU601), ((1280, 64), Colorspace.ITU709)])
def test_colours_that_a_video_does_not_name_are_those_that_players_take(
    tmp_path: Path, size: tuple[int, int], matrix: Colorspace
) -> None:
    green = (0, 177, 64)
    image = av.VideoFrame.from_ndarray(np.full((*size[::-1], 3), green, np.uint8), format="rgb24")
    with av.open(str(tmp_path / "clip.mp4"), "w") as container:
        stream = container.add_stream("mpeg4", rate=30, options={"qscale": "2"})
        stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
        frame = image.reformat(format="yuv420p", dst_colorspace=matrix)
        container.mux(stream.encode(frame))
        container.mux(stream.encode())
    source = open_source(str(tmp_path / "clip.mp4"))
    assert next(source.frames()).rgb[32, 48].tolist() == pytest.approx(green, abs=4)


@pytest.mark.parametrize("total", [33, 63, 95, 150])
def test_samples_reach_the_end_of_a_clip_of_any_length(total: int) -> None:
    numbers = spread(total, 32)
    assert len(numbers) == 32
    assert numbers[-1] >= total - total / 32 - 1
    assert max(np.diff(numbers)) - min(np.diff(numbers)) <= 1
    assert spread(5, 32) == [0, 1, 2, 3, 4]
    assert spread(0, 32) == []


def test_samples_spread_over_the_clip(make_clip: Clip) -> None:
    source = open_source(str(make_clip(pts=tuple(range(0, 60000, 1000)))))
    samples = source.samples(6)
    assert [sample.pts for sample in samples] == [0, 10000, 20000, 30000, 40000, 50000]
    everything = list(source.frames())
    assert [everything[sample.number or 0].pts for sample in samples] == [sample.pts for sample in samples]


@pytest.mark.parametrize("options", [{}, {"live": "1"}], ids=["length told", "length not told"])
def test_samples_spread_over_a_clip_whose_stream_tells_no_length(make_clip: Clip, options: dict[str, str]) -> None:
    clip = make_clip("clip.mkv", tuple(range(0, 60000, 1000)), options=options)
    with av.open(str(clip)) as container:
        assert container.streams.video[0].duration is None
        assert (container.duration is None) == bool(options)
    source = open_source(str(clip))
    assert [sample.number for sample in source.samples(6)] == [0, 10, 20, 30, 40, 50]
    assert source.frame_count == (None if options else 60)


def test_a_long_clip_whose_stream_tells_no_length_is_sampled_to_its_end(
    make_clip: Clip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gemheads.app.files.video.WHOLE_CLIP_FRAMES", 30)
    source = open_source(str(make_clip("clip.mkv", tuple(range(0, 240000, 1000)))))  # a key frame each 12 frames
    assert source.samples(20)[-1].seconds > 7


def test_of_several_videos_in_a_file_the_largest_is_shown(tmp_path: Path) -> None:
    clip = tmp_path / "cameras.mp4"
    sizes = (64, 48), (128, 96), (128, 96)
    with av.open(str(clip), "w") as container:
        streams = [container.add_stream("mpeg4", rate=25) for _ in sizes]
        for stream, (stream.width, stream.height) in zip(streams, sizes, strict=True):
            stream.pix_fmt = "yuv420p"
        for stream, bright, (width, height) in zip(streams, (20, 120, 220), sizes, strict=True):
            picture = av.VideoFrame.from_ndarray(np.full((height, width, 3), bright, np.uint8), format="rgb24")
            container.mux(stream.encode(picture))
            container.mux(stream.encode())
    (frame,) = open_source(str(clip)).frames()
    assert frame.rgb.shape == (96, 128, 3)
    assert abs(float(frame.rgb.mean()) - 120) < 10


def test_times_are_counted_from_where_the_clock_of_a_transport_stream_begins(make_clip: Clip) -> None:
    ticks = (0, 1000, 2200, *range(3000, 30000, 1000))
    source = open_source(str(make_clip("clip.ts", tuple(3600 * 30000 + tick for tick in ticks))))
    assert [frame.pts for frame in source.frames()] == [3 * tick for tick in ticks]
    assert [sample.seconds for sample in source.samples(3)] == pytest.approx([0, 1 / 3, 2 / 3])


def test_a_first_picture_that_mp4_shows_late_stays_late(make_clip: Clip) -> None:
    assert [frame.pts for frame in open_source(str(make_clip(pts=(2002, 3003)))).frames()] == [2002, 3003]


@pytest.mark.parametrize(("pixel_aspect", "size"), [(Fraction(2), (192, 64)), (Fraction(1, 2), (48, 64))])
def test_pixels_that_are_not_square_are_made_so(make_clip: Clip, pixel_aspect: Fraction, size: tuple[int, int]) -> None:
    source = open_source(str(make_clip(pixel_aspect=pixel_aspect)))
    assert source.size == size
    rgb = next(source.frames()).rgb
    assert rgb[5, size[0] // 2 - 5].mean() > 60
    assert rgb[5, size[0] // 2 + 5].mean() < 60


def test_a_pixel_of_no_possible_shape_is_taken_for_a_square(make_clip: Clip) -> None:
    assert open_source(str(make_clip(pixel_aspect=Fraction(250)))).size == (96, 64)


def test_sound_alone_is_told(tmp_path: Path) -> None:
    with av.open(str(tmp_path / "sound.mp4"), "w") as container:
        stream = container.add_stream("aac", rate=48000, layout="mono")
        tone = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        tone.sample_rate, tone.pts = 48000, 0
        container.mux(stream.encode(tone))
        container.mux(stream.encode())
    with pytest.raises(InputError, match="there is no video in this file"):
        open_source(str(tmp_path / "sound.mp4"))


def test_a_clip_of_zero_length_is_told(make_clip: Clip) -> None:
    with pytest.raises(InputError, match=r"no picture|not a readable video"):
        open_source(str(make_clip(pts=())))


def test_a_torn_video_gives_what_can_be_read(make_clip: Clip) -> None:
    clip = make_clip(pts=tuple(range(0, 60000, 1000)), size=(320, 240))
    data = clip.read_bytes()
    clip.write_bytes(data[: len(data) * 2 // 3])
    assert 5 < len(list(open_source(str(clip)).frames())) < 60


def _begun_late(clip: Path, secs: int) -> Path:
    """The same file as if its fragments had been cut from a stream that has run so long."""
    content = bytearray(clip.read_bytes())
    scale = struct.unpack_from(">I", content, content.find(b"mdhd") + 16)[0]
    at = -1
    while (at := content.find(b"tfdt", at + 1)) >= 0:
        (time,) = struct.unpack_from(">Q", content, at + 8)
        struct.pack_into(">Q", content, at + 8, time + secs * scale)
    clip.write_bytes(content)
    return clip


def test_fragments_of_a_running_stream_begin_at_zero_and_a_late_first_picture_stays_late(
    make_clip: Clip, tmp_path: Path
) -> None:
    assert [f.pts for f in VideoFile(make_clip(pts=(2002, 3003, 4004))).frames()] == [2002, 3003, 4004]
    source = VideoFile(_begun_late(make_clip("cut.mp4", pts=tuple(range(0, 30030, 1001)), flags="empty_moov"), 3600))
    assert [f.pts for f in source.frames()] == list(range(0, 30030, 1001))
    assert source.frame_count == 30
    reordered = grey_clip(tmp_path / "reordered.mp4", "frag_keyframe+empty_moov")
    for clip in (reordered, _begun_late(reordered, 3600)):
        assert (VideoFile(clip).frame_count, next(VideoFile(clip).frames()).pts) == (30, 0)


@pytest.mark.parametrize(("name", "transfer", "signal"), [("pq.mp4", 16, 0.5807), ("hlg.mp4", 18, 0.75)])
def test_white_of_high_dynamic_range_is_white(tmp_path: Path, name: str, transfer: int, signal: float) -> None:
    """ITU-R BT.2408 says at which signal it is."""
    with av.open(str(tmp_path / name), "w") as container:
        stream = container.add_stream("libx264", rate=30, options={"qp": "0"})
        stream.width, stream.height, stream.pix_fmt = 64, 64, "yuv420p10le"
        codec = stream.codec_context
        codec.colorspace, codec.color_primaries, codec.color_trc, codec.color_range = 9, 9, transfer, ColorRange.MPEG
        frame = av.VideoFrame(64, 64, "yuv420p10le")
        for plane, level in zip(frame.planes, (round(64 + 876 * signal), 512, 512), strict=True):
            plane.update(np.full((plane.height, plane.line_size // 2), level, np.uint16).tobytes())
        container.mux(stream.encode(frame))
        container.mux(stream.encode())
    assert next(VideoFile(tmp_path / name).frames()).rgb.min() >= 253
