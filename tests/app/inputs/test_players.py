"""Videos, pictures and tracks in time, by a clock that is turned by hand."""

from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from gemheads.app.errors import InputError
from gemheads.app.inputs.pictures import open_pictures
from gemheads.app.inputs.source import LiveSource, PoseFrame, SourceLost, WeightsFrame
from gemheads.app.inputs.trackplayer import open_performance, open_track
from gemheads.app.inputs.videoplayer import MOST_AT_ONCE, VideoPlayer
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, save_track

from ..clips import grey_clip
from ..conftest import Clip
from ..scripted import Clock

TICKS = tuple(range(0, 30030, 1001))
"""One second at 29.97 a second."""


@pytest.fixture
def clock() -> Clock:
    return Clock()


def watch(source: LiveSource, clock: Clock, secs: float, step: float = 1 / 120) -> list[float]:
    """The source's times as they come while so much time goes by."""
    seen = []
    for _ in range(round(secs / step)):
        delivery = source.read(0)
        if delivery is not None:
            seen.append(delivery.seconds)
        clock.now += step
    return seen


def test_a_video_comes_by_its_own_times_and_begins_again(make_clip: Clip, clock: Clock) -> None:
    video = VideoPlayer(make_clip(pts=TICKS), clock)
    seen = watch(video, clock, 1.0)
    assert seen == pytest.approx([tick / 30000 for tick in TICKS])
    assert video.transport.duration == pytest.approx(1.001, abs=0.04)
    again = watch(video, clock, 0.5)
    assert again[0] == 0
    assert len(again) == pytest.approx(15, abs=2)
    assert video.drops == 0


def test_uneven_times_are_kept(make_clip: Clip, clock: Clock) -> None:
    ticks = (0, 300, 3000, 3300, 9000)
    video = VideoPlayer(make_clip(pts=ticks), clock)
    begun, came = clock.now, []
    for _ in range(240):
        frame = video.read(0)
        if frame is not None and len(came) < 5:
            came.append(clock.now - begun)
        clock.now += 1 / 600
    assert came == pytest.approx([tick / 30000 for tick in ticks], abs=0.003)


def test_a_video_has_square_pixels(make_clip: Clip, clock: Clock) -> None:
    frame = VideoPlayer(make_clip(pixel_aspect=Fraction(2)), clock).read(0)
    assert frame is not None
    assert frame.rgb.shape == (64, 192, 3)


def test_a_video_pauses_steps_and_seeks_exactly(make_clip: Clip, clock: Clock) -> None:
    video = VideoPlayer(make_clip(pts=TICKS), clock)
    watch(video, clock, 0.3)
    video.transport.pause()
    assert watch(video, clock, 2.0) == []
    shown = []
    for action in (
        lambda: video.transport.seek(0.5005),
        lambda: video.transport.step(1),
        lambda: video.transport.step(-3),
    ):
        action()
        frame = video.read(0)
        assert frame is not None
        shown.append(frame.seconds)
    assert shown == pytest.approx([0.5005, 0.5005 + 0.0334, 0.5005 - 2 * 0.0334], abs=0.001)
    assert video.read(0) is None


@pytest.mark.parametrize("suffix", [".ts", ".flv", ".avi", ".mkv", ".mp4", ".h264"])
def test_every_frame_is_found_again_whatever_holds_it(tmp_path: Path, clock: Clock, suffix: str) -> None:
    """All in one group of pictures that are not stored as they are shown: transport streams are sent before its
    beginning and come out behind it, AVI tells only when pictures are decoded."""
    video = VideoPlayer(grey_clip(tmp_path / f"clip{suffix}"), clock)
    rounds = [number for number, _ in seen_numbers(video, clock, 2.5)]
    assert rounds[:60] == 2 * list(range(30))
    video.transport.pause()
    for number in (15, 3, 29, 0):
        video.transport.seek((number + 0.01) / 25)
        ((shown, _),) = seen_numbers(video, clock, 0.1)
        assert shown == number


def test_a_loop_of_fragments_loses_none_of_the_frames_that_are_stored_in_another_order(
    tmp_path: Path, clock: Clock
) -> None:
    video = VideoPlayer(grey_clip(tmp_path / "clip.mp4", "frag_keyframe+empty_moov"), clock)
    assert [number for number, _ in seen_numbers(video, clock, 2.5)][:60] == 2 * list(range(30))


def test_how_long_a_video_is_that_does_not_tell_is_learnt_at_its_end(tmp_path: Path, clock: Clock) -> None:
    path = grey_clip(tmp_path / "clip.h264")
    played, sought = VideoPlayer(path, clock), VideoPlayer(path, clock)
    watch(played, clock, 0.9)
    assert played.transport.duration == float("inf")
    watch(played, clock, 0.5)
    assert (played.transport.duration, played.transport.playing) == (pytest.approx(1.2), True)
    sought.transport.pause()
    sought.transport.seek(1e6)
    frame = sought.read(0)
    assert frame is not None
    assert (frame.seconds, sought.transport.position) == (pytest.approx(29 / 25), pytest.approx(1.2))


def seen_numbers(video: VideoPlayer, clock: Clock, secs: float) -> list[tuple[int, float]]:
    """What grey frames come, by their number, and when."""
    seen = []
    for _ in range(round(secs * 100)):
        frame = video.read(0)
        if frame is not None:
            seen.append((round(float(frame.rgb.mean()) / 8), clock.now))
        clock.now += 0.01
    return seen


def test_a_paused_video_steps_from_the_frame_that_is_shown(make_clip: Clip, clock: Clock) -> None:
    video = VideoPlayer(make_clip(pts=TICKS), clock)
    watch(video, clock, 10.7 / 29.97)
    video.transport.pause()
    shown = []
    for frames in (1, -1, -1):
        video.transport.step(frames)
        frame = video.read(0)
        assert frame is not None
        shown.append(round(frame.seconds * 29.97))
    assert shown == [11, 10, 9]


def test_a_video_that_is_paused_before_it_is_open_shows_its_first_frame(make_clip: Clip, clock: Clock) -> None:
    video = VideoPlayer(make_clip(pts=TICKS), clock)
    video.transport.pause()
    frame = video.read(0)
    assert frame is not None
    assert frame.seconds == 0
    assert video.read(0) is None


def test_a_video_ends_where_it_does_not_loop_and_plays_again(make_clip: Clip, clock: Clock) -> None:
    video = VideoPlayer(make_clip(pts=TICKS), clock)
    video.transport.loop = False
    assert len(watch(video, clock, 3.0)) == 30
    assert not video.transport.playing
    video.transport.play()
    frame = video.read(0)
    assert frame is not None
    assert frame.seconds == 0


def test_what_is_late_is_passed_over_and_the_clock_slips_when_it_is_hopeless(make_clip: Clip, clock: Clock) -> None:
    video = VideoPlayer(make_clip(pts=TICKS), clock)
    video.read(0)
    clock.now += 0.11
    frame = video.read(0)
    assert frame is not None
    assert frame.seconds == pytest.approx(0.1, abs=0.002)
    assert video.drops == 2
    clock.now += 0.8
    frame = video.read(0)
    assert frame is not None
    assert frame.seconds == pytest.approx(0.1 + MOST_AT_ONCE / 29.97, abs=0.002)
    assert video.transport.position == pytest.approx(frame.seconds)


@pytest.mark.parametrize(("kept", "told"), [(0, "empty"), (None, "holds no picture")], ids=["emptied", "scrambled"])
def test_a_video_that_is_written_over_while_it_plays_is_lost_and_freezes_nothing(
    tmp_path: Path, clock: Clock, kept: int | None, told: str
) -> None:
    """Longer than what is read ahead of it; its index is whole where all but its beginning is scrambled."""
    path, random = tmp_path / "clip.mp4", np.random.default_rng(0)
    with av.open(str(path), "w", options={"movflags": "faststart"}) as container:
        stream = container.add_stream("libx264", rate=25, options={"preset": "ultrafast"})
        stream.width, stream.height, stream.pix_fmt = 160, 120, "yuv420p"
        for _ in range(25):
            picture = random.integers(0, 255, (120, 160, 3), np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, "rgb24")))
        container.mux(stream.encode())
    video, size = VideoPlayer(path, clock), path.stat().st_size
    assert len(watch(video, clock, 0.5)) > 10
    with path.open("r+b") as file:
        if kept is None:
            file.seek(4000)
            file.write(random.bytes(size - 4000))
        else:
            file.truncate(kept)
    with pytest.raises(SourceLost, match=told):
        watch(video, clock, 3.0)


def test_what_is_no_video_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("not a video")
    with pytest.raises(InputError, match=r"text\.mp4"):
        VideoPlayer(tmp_path / "text.mp4")


def test_pictures_come_at_their_rate_and_a_broken_one_is_counted(tmp_path: Path, clock: Clock) -> None:
    for index in range(6):
        cv2.imwrite(str(tmp_path / f"shot_{index}.png"), np.full((32, 48, 3), 40 * index, np.uint8))
    (tmp_path / "shot_3.png").write_bytes(b"broken")
    player = open_pictures(tmp_path, 10.0, clock)
    assert watch(player, clock, 0.595) == pytest.approx([0, 0.1, 0.2, 0.4, 0.5])
    assert player.rejected == 1
    assert (player.kind, player.transport.duration) == ("pictures", pytest.approx(0.6))


def test_one_picture_stays_and_is_looked_at_again(tmp_path: Path, clock: Clock) -> None:
    cv2.imwrite(str(tmp_path / "face.png"), np.full((32, 48, 3), 90, np.uint8))
    player = open_pictures(tmp_path / "face.png", clock=clock)
    assert len(watch(player, clock, 1.99)) == 10


def test_a_coefficient_track_plays_for_its_avatar(tmp_path: Path, clock: Clock) -> None:
    poses = tuple(Pose(np.full(4, index, np.float32), np.zeros(3, np.float32)) for index in range(10))
    save_track(Track("Tiny", "abc", Fraction(1, 25), Fraction(25), np.arange(10), poses), tmp_path / "t.safetensors")
    player = open_track(tmp_path / "t.safetensors", clock)
    clock.now += 0.2
    delivery = player.read(0)
    assert isinstance(delivery, PoseFrame)
    assert (delivery.avatar_sha256, delivery.pose.coefficients[0]) == ("abc", 5)
    assert player.drops == 0  # nobody had looked yet


def test_the_performance_plays_in_a_circle(clock: Clock) -> None:
    demo = open_performance(clock)
    assert isinstance(demo.read(0), WeightsFrame)
    seen = watch(demo, clock, demo.transport.duration + 1, step=1 / 60)
    assert len(seen) == pytest.approx(30 * (demo.transport.duration + 1), rel=0.02)
    assert min(np.diff(seen)) < -5


def test_waiting_ends_with_a_button(make_clip: Clip) -> None:
    import threading
    import time

    video = VideoPlayer(make_clip(pts=TICKS))
    video.transport.pause()
    threading.Timer(0.05, video.transport.step, [3]).start()
    begun = time.perf_counter()
    while (frame := video.read(5.0)) is None or frame.seconds < 0.05:
        assert time.perf_counter() - begun < 4
    video.close()
