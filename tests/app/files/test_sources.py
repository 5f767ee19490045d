import os
import struct
import sys
import zlib
from fractions import Fraction
from pathlib import Path

import av
import cv2
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


def write_png(path: Path, value: int, size: tuple[int, int] = (20, 16)) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.full((size[1], size[0], 3), value, np.uint8))


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


def test_large_photographs_are_scaled_down_as_videos_are(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((100, 4000, 3), np.uint8))
    scaled, whole = open_source(str(tmp_path)), open_source(str(tmp_path), longest_side=5000)
    for source, size in ((scaled, (1920, 48)), (whole, (4000, 100))):
        assert source.size == size
        assert next(source.frames()).rgb.shape == source.samples(1)[0].rgb.shape == (size[1], size[0], 3)


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


@pytest.mark.skipif(sys.platform == "win32", reason="no file can be called so")
def test_a_name_with_a_colon_is_no_protocol(make_clip: Clip, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make_clip("2024-05-01T10:30:00.mp4")
    monkeypatch.chdir(tmp_path)
    assert len(list(open_source("2024-05-01T10:30:00.mp4").frames())) == 4


def test_what_macos_puts_beside_a_picture_is_not_read(tmp_path: Path) -> None:
    write_png(tmp_path / "shot.png", 7)
    (tmp_path / "._shot.png").write_bytes(b"\0\5\x16\7 attributes")
    assert [int(frame.rgb[0, 0, 0]) for frame in open_source(str(tmp_path)).frames()] == [7]


def test_folders_are_read_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for number in (10, 2, 1):
        write_png(tmp_path / "shots" / f"frame{number}.png", number)
    (tmp_path / "shots" / "notes.txt").touch()
    source = open_source(str(tmp_path / "shots"), Fraction(25))
    assert [int(frame.rgb[0, 0, 0]) for frame in source.frames()] == [1, 2, 10]
    assert [frame.seconds for frame in source.frames()] == pytest.approx([0, 0.04, 0.08])
    assert source.frame_count == 3
    assert source.size == (20, 16)


@pytest.mark.parametrize("pattern", ["shot_%03d.png", "shot_*.png", "shot_0[0-9]?.png"])
def test_sequences_by_pattern(tmp_path: Path, pattern: str) -> None:
    for number in (0, 1, 12):
        write_png(tmp_path / f"shot_{number:03d}.png", number)
    write_png(tmp_path / "other.png", 99)
    source = open_source(str(tmp_path / pattern))
    assert [int(frame.rgb[0, 0, 0]) for frame in source.frames()] == [0, 1, 12]


def test_a_pattern_names_numbers_alone(tmp_path: Path) -> None:
    for name in ("shot_0001.png", "shot_0001_mask.png", "shot_left_0001.png", "shot_²1.png"):
        write_png(tmp_path / name, 7)
    source = open_source(str(tmp_path / "shot_%04d.png"))
    assert len(list(source.frames())) == 1
    assert len(list(open_source(str(tmp_path)).frames())) == 4


@pytest.mark.parametrize("size", [(8, 20), (20, 1), (16400, 20)])
def test_a_picture_in_which_no_face_can_be_looked_for_is_told(tmp_path: Path, size: tuple[int, int]) -> None:
    write_png(tmp_path / "thin.png", 7, size)
    with pytest.raises(InputError, match=f"{size[0]}x{size[1]} pixels; give pictures with sides from 16 to 16384"):
        open_source(str(tmp_path / "thin.png"))


def test_one_picture_is_a_clip_of_one_frame(tmp_path: Path) -> None:
    write_png(tmp_path / "ä face.png", 7)
    assert [int(frame.rgb[0, 0, 0]) for frame in open_source(str(tmp_path / "ä face.png")).frames()] == [7]


def test_colours_are_red_green_blue(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "red.png"), np.full((20, 20, 3), (0, 0, 200), np.uint8))
    assert next(open_source(str(tmp_path / "red.png")).frames()).rgb[0, 0].tolist() == [200, 0, 0]


@pytest.mark.parametrize("depth", [np.uint8, np.uint16])
def test_a_png_with_alpha_is_laid_on_white(tmp_path: Path, depth: type) -> None:
    most = np.iinfo(depth).max
    image = np.zeros((20, 20, 4), depth)
    image[:, :10] = (0, 0, most, 0)  # red that nobody is to see
    image[:, 10:] = (most, 0, 0, most)
    cv2.imwrite(str(tmp_path / "cut.png"), image)
    rgb = next(open_source(str(tmp_path / "cut.png")).frames()).rgb
    assert rgb[0, 0].tolist() == [255, 255, 255]
    assert rgb[0, 15].tolist() == [0, 0, 255]


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


@pytest.mark.parametrize("kind", [2, 3], ids=["one colour of all", "one of a palette"])
def test_a_png_that_names_a_transparent_colour_is_laid_on_white(tmp_path: Path, kind: int) -> None:
    row = b"\0" + (bytes(10) + b"\1" * 10 if kind == 3 else bytes(30) + b"\xff\0\0" * 10)
    parts = [chunk(b"IHDR", struct.pack(">IIBBBBB", 20, 20, 8, kind, 0, 0, 0))]
    parts += [chunk(b"PLTE", bytes([0, 0, 0, 255, 0, 0]))] if kind == 3 else []
    parts += [chunk(b"tRNS", b"\0\xff" if kind == 3 else bytes(6))]
    parts += [chunk(b"IDAT", zlib.compress(row * 20)), chunk(b"IEND", b"")]
    (tmp_path / "named.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))
    rgb = next(open_source(str(tmp_path / "named.png")).frames()).rgb
    assert rgb[0, 0].tolist() == [255, 255, 255]
    assert rgb[0, 15].tolist() == [255, 0, 0]


@pytest.mark.parametrize("quality", [101, 95], ids=["without loss", "with loss"])
def test_a_webp_with_alpha_is_laid_on_white(tmp_path: Path, quality: int) -> None:
    image = np.zeros((32, 32, 4), np.uint8)
    image[:, 16:] = (255, 0, 0, 255)
    for alpha in (True, False):
        path = tmp_path / f"{alpha}.webp"
        cv2.imwrite(str(path), image if alpha else image[..., :3], [cv2.IMWRITE_WEBP_QUALITY, quality])
        rgb = next(open_source(str(path)).frames()).rgb
        assert rgb[5, 5].tolist() == [255 * alpha] * 3
        assert rgb[5, 28].tolist() == pytest.approx([0, 0, 255], abs=3)


def test_what_is_missing_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.mp4: no such file or folder"):
        open_source(str(tmp_path / "none.mp4"))
    with pytest.raises(InputError, match="no such file or folder"):
        open_source(str(tmp_path / "none_%03d.png"))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no named pipes")
def test_a_pipe_is_told(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.mp4")
    with pytest.raises(InputError, match=r"pipe\.mp4: a pipe or device, and a driver is read twice; save it"):
        open_source(str(tmp_path / "pipe.mp4"))


def test_a_folder_without_pictures_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a folder without pictures; it needs files ending in .*\.png"):
        open_source(str(tmp_path))


def test_an_empty_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "empty.mp4").touch()
    with pytest.raises(InputError, match="the file is empty"):
        open_source(str(tmp_path / "empty.mp4"))


def test_what_is_not_a_video_is_told(tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("not a video at all " * 100)
    with pytest.raises(InputError, match="not a readable video"):
        open_source(str(tmp_path / "text.mp4"))


def test_a_picture_that_is_none_is_told(tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"\x89PNG nothing")
    with pytest.raises(InputError, match=r"broken\.png: is not a picture"):
        open_source(str(tmp_path / "broken.png"))


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


@pytest.mark.parametrize("name", ["a.png", "a.webp"])
def test_an_animation_is_no_picture(tmp_path: Path, name: str) -> None:
    path, animation = tmp_path / name, cv2.Animation()
    animation.frames = [np.full((32, 32, 3), shade, np.uint8) for shade in (40, 200)]
    animation.durations = [40, 40]
    _, content = cv2.imencodeanimation(path.suffix, animation)
    path.write_bytes(content.tobytes())
    with pytest.raises(InputError, match="is an animation, of which one picture would be read; convert it to mp4"):
        open_source(str(path))
    assert cv2.imwrite(str(path), animation.frames[0])
    assert open_source(str(path)).size == (32, 32)


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
