import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from av.video.reformatter import ColorRange, Colorspace
from gemheads.app.errors import OutputError, UsageError
from gemheads.app.files.claim import TakenError, claimed_folder
from gemheads.app.files.sinks import FolderSink, VideoSink, is_whole, video_codec
from gemheads.app.files.video import VideoFile

from ..conftest import Clip

BASE = Fraction(1, 30000)
VARIABLE = (2002, 3003, 4104, 4500, 9001)


def picture(value: int, channels: int = 3) -> np.ndarray:
    return np.full((64, 96, channels), value, np.uint8)


def write(sink: VideoSink | FolderSink, pts: tuple[int, ...], channels: int = 3, whole: bool = True) -> None:
    for index, instant in enumerate(pts):
        sink.write(index, picture(40 + index, channels), instant)
    sink.close(whole)


def read_times(path: Path) -> list[Fraction]:
    with av.open(str(path)) as container:
        return [frame.pts * frame.time_base for frame in container.decode(video=0)]


@pytest.mark.parametrize("suffix", [".mp4", ".mov"])
@pytest.mark.parametrize("base", [BASE, Fraction(1, 25), Fraction(1, 90000), Fraction(1, 1000)])
def test_times_are_kept_exactly_even_when_the_first_is_late(tmp_path: Path, suffix: str, base: Fraction) -> None:
    path = tmp_path / f"out{suffix}"
    write(VideoSink(path, (96, 64), base, Fraction(30), False, None), VARIABLE)
    assert read_times(path) == [instant * base for instant in VARIABLE]


def test_sound_is_copied_packet_by_packet(tmp_path: Path, make_clip: Clip) -> None:
    pts = tuple(range(0, 30030, 1001))
    clip = make_clip(pts=pts, sound=True)
    path = tmp_path / "out.mp4"
    write(VideoSink(path, (96, 64), BASE, Fraction(30), False, clip), pts)

    def sound(file: Path) -> list[tuple[Fraction, bytes]]:
        with av.open(str(file)) as container:
            track = container.streams.audio[0]
            return [(p.pts * p.time_base, bytes(p)) for p in container.demux(track) if p.size]

    assert len(sound(clip)) > 40
    assert sound(path) == sound(clip)
    assert read_times(path) == read_times(clip)


def test_sound_goes_into_webm_as_opus(tmp_path: Path, make_clip: Clip) -> None:
    pts = tuple(range(0, 30030, 1001))
    path = tmp_path / "out.webm"
    write(VideoSink(path, (96, 64), BASE, Fraction(30), False, make_clip(pts=pts, sound=True)), pts)
    with av.open(str(path)) as container:
        assert container.streams.audio[0].codec_context.name == "opus"
        heard = sum(frame.samples for frame in container.decode(audio=0))
    assert heard == pytest.approx(48000, rel=0.1)


def test_an_unfinished_video_has_a_partial_name_and_plays(tmp_path: Path) -> None:
    path = tmp_path / "out.mp4"
    write(VideoSink(path, (96, 64), BASE, Fraction(30), False, None), VARIABLE, whole=False)
    assert not path.exists()
    assert not is_whole(path)
    assert len(read_times(tmp_path / "out.partial.mp4")) == len(VARIABLE)


def test_a_result_that_another_run_is_writing_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "out.mp4"
    first = VideoSink(path, (96, 64), BASE, Fraction(30), False, None)
    with pytest.raises(TakenError, match=r"out\.partial\.mp4: another run is writing it; wait for that, or choose"):
        VideoSink(path, (96, 64), BASE, Fraction(30), False, None)
    write(first, VARIABLE)
    assert len(read_times(path)) == len(VARIABLE)
    write(VideoSink(path, (96, 64), BASE, Fraction(30), False, None), VARIABLE[:2], whole=False)
    write(VideoSink(path, (96, 64), BASE, Fraction(30), False, None), VARIABLE[:3])  # what a run left is taken over
    assert len(read_times(path)) == 3


@pytest.mark.skipif(sys.platform == "win32", reason="folders are not locked there")
def test_a_folder_that_another_run_is_writing_into_is_left_alone(tmp_path: Path) -> None:
    with (
        claimed_folder(tmp_path / "out"),
        pytest.raises(TakenError, match="another run is writing into it"),
        claimed_folder(tmp_path / "out"),
    ):
        pass
    with claimed_folder(tmp_path / "out"):
        pass


def test_no_table_says_where_fragments_are(tmp_path: Path) -> None:
    """What signs a file moves them, and players that believe the table find nothing."""
    sink = VideoSink(tmp_path / "out.mp4", (96, 64), BASE, Fraction(30), False, None)
    for index in range(3):
        sink.write(index, np.zeros((64, 96, 3), np.uint8), index * 1000)
    sink.close(True)
    assert b"moof" in (content := (tmp_path / "out.mp4").read_bytes())
    assert b"mfra" not in content


def test_a_killed_run_leaves_all_but_the_last_second(tmp_path: Path) -> None:
    sink = VideoSink(tmp_path / "out.mp4", (96, 64), BASE, Fraction(30), False, None)
    for index in range(90):
        sink.write(index, picture(index), index * 1000)
    copy = tmp_path / "as-left.mp4"
    copy.write_bytes((tmp_path / "out.partial.mp4").read_bytes())  # what a killed process leaves on disk
    sink.close(False)
    assert len(read_times(copy)) >= 30


@pytest.mark.parametrize(("name", "encoder"), [("h.mp4", "libx264"), ("m.mp4", "mpeg4"), ("v.webm", "libvpx-vp9")])
@pytest.mark.parametrize(("rate", "step"), [(1000, 1001), (30, 7500), (1, 1001)])
def test_a_fragment_begins_each_second_whatever_the_rate_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, encoder: str, rate: int, step: int
) -> None:
    monkeypatch.setattr("gemheads.app.files.sinks.has_encoder", lambda codec: codec == encoder)
    path = tmp_path / name
    sink = VideoSink(path, (96, 64), BASE, Fraction(rate), False, None)
    for index, pts in enumerate(range(0, 4 * 30000, step)):
        sink.write(index, picture(90), pts)
    sink.close(True)
    with av.open(str(path)) as container:
        keys = [float(p.pts * p.time_base) for p in container.demux(video=0) if p.size and p.is_keyframe]
    assert np.diff(keys) == pytest.approx(1, abs=0.04)
    assert len(keys) == 4


@pytest.mark.parametrize(("name", "decoder"), [("out.mov", "prores"), ("out.webm", "libvpx-vp9")])
def test_transparent_videos_keep_their_alpha(tmp_path: Path, name: str, decoder: str) -> None:
    sink = VideoSink(tmp_path / name, (96, 64), BASE, Fraction(30), True, None)
    image = picture(200, 4)
    image[:32, :, 3] = 0
    sink.write(0, image, 0)
    sink.close(True)
    reader = av.CodecContext.create(decoder, "r")
    with av.open(str(tmp_path / name)) as container:
        stream = container.streams.video[0]
        reader.extradata = stream.codec_context.extradata
        reader.width, reader.height = 96, 64
        frames = [
            frame for packet in container.demux(stream) for frame in reader.decode(packet if packet.size else None)
        ]
    alpha = frames[0].to_ndarray(format="rgba")[..., 3]
    assert int(alpha[10, 40]) < 8
    assert int(alpha[50, 40]) == pytest.approx(200, abs=4)


@pytest.mark.parametrize(
    ("name", "encoder", "transparent"),
    [("h.mp4", "", False), ("m.mp4", "mpeg4", False), ("v.webm", "", False), ("a.webm", "", True), ("a.mov", "", True)],
)
def test_videos_say_how_their_colours_are_to_be_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, encoder: str, transparent: bool
) -> None:
    if encoder:
        monkeypatch.setattr("gemheads.app.files.sinks.has_encoder", lambda codec: codec == encoder)
    green = (0, 177, 64)
    sink = VideoSink(tmp_path / name, (96, 64), BASE, Fraction(30), transparent, None)
    sink.write(0, np.full((64, 96, 3 + transparent), (*green, 255)[: 3 + transparent], np.uint8), 0)
    sink.close(True)
    with av.open(str(tmp_path / name)) as container:
        frame = next(container.decode(video=0))
    assert (frame.colorspace, frame.color_range) == (Colorspace.ITU709, ColorRange.MPEG)
    assert frame.to_ndarray(format="rgb24")[32, 48].tolist() == pytest.approx(green, abs=4)


def test_folders_hold_pngs_with_straight_alpha_and_times(tmp_path: Path) -> None:
    sink = FolderSink(tmp_path / "out", BASE, resume=False)
    image = np.zeros((4, 6, 4), np.uint8)
    image[...] = (250, 20, 10, 128)
    sink.write(0, image, 30000)
    assert not is_whole(tmp_path / "out")
    sink.close(True)
    assert is_whole(tmp_path / "out")
    back = cv2.imread(str(tmp_path / "out" / "frame_000000.png"), cv2.IMREAD_UNCHANGED)
    assert back[0, 0].tolist() == [10, 20, 250, 128]
    assert (tmp_path / "out" / "times.csv").read_text().splitlines() == ["file,seconds", "frame_000000.png,1.000000000"]


def test_a_folder_is_continued_only_when_asked(tmp_path: Path) -> None:
    write(FolderSink(tmp_path / "out", BASE, resume=False), (0, 1), whole=False)
    assert FolderSink(tmp_path / "out", BASE, resume=True).has(1)
    assert not FolderSink(tmp_path / "out", BASE, resume=True).has(2)
    assert not FolderSink(tmp_path / "out", BASE, resume=False).has(1)


def test_alpha_where_it_cannot_be_is_told() -> None:
    with pytest.raises(UsageError, match=r"\.mp4 cannot be transparent; name the result \.mov"):
        video_codec(".mp4", True)


def test_a_place_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written"):
        VideoSink(tmp_path / "file" / "out.mp4", (96, 64), BASE, Fraction(30), False, None)
    with pytest.raises(OutputError, match="cannot be written"):
        FolderSink(tmp_path / "file" / "out", BASE, False)


FILL = """
import resource, sys
import numpy as np
from fractions import Fraction
from pathlib import Path
from gemheads.app.errors import OutputError
from gemheads.app.files.sinks import VideoSink
resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
sink = VideoSink(Path(sys.argv[1]), (96, 64), Fraction(1, 30), Fraction(30), False, None)
rng = np.random.default_rng(0)
try:
    for i in range(3000):
        sink.write(i, rng.integers(0, 255, (64, 96, 3), dtype=np.uint8), i)
except OutputError as error:
    print(error)
    try:
        sink.close(False)
    except OutputError as error:
        print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits on file sizes are set by POSIX calls")
def test_a_full_disk_is_told_and_what_was_written_plays(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FILL, str(tmp_path / "out.mp4")], capture_output=True, text=True, timeout=60, check=False
    )
    said = done.stdout.splitlines()
    assert len(said) == 2, done.stderr  # while it writes, and once more as it closes
    for line in said:
        assert "no space left; the" in line
        assert "frames written so far are in" in line
    assert len(list(VideoFile(tmp_path / "out.partial.mp4").frames())) >= 29


@pytest.mark.skipif(sys.platform == "win32", reason="limits on file sizes are set by POSIX calls")
@pytest.mark.parametrize("suffix", [".mp4", ".mov", ".webm"])
@pytest.mark.parametrize("missing", [1, 1500])
def test_a_disk_that_is_full_at_the_very_end_is_told(tmp_path: Path, suffix: str, missing: int) -> None:
    import resource

    def written(name: str) -> Path:
        rng, path = np.random.default_rng(0), tmp_path / f"{name}{suffix}"
        sink = VideoSink(path, (96, 64), Fraction(1, 30), Fraction(30), False, None)
        for index in range(40):
            coarse = rng.integers(0, 255, (8, 12, 3))
            sink.write(index, coarse.repeat(8, 0).repeat(8, 1).astype(np.uint8), index)
        sink.close(True)
        return path

    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (written("whole").stat().st_size - missing, limits[1]))
    try:
        with pytest.raises(OutputError, match="no space left; the") as told:
            written("cut")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    left = tmp_path / f"cut.partial{suffix}"
    assert f"the {len(list(VideoFile(left).frames()))} frames written so far are in {left}" in str(told.value)
    assert not is_whole(tmp_path / f"cut{suffix}")
