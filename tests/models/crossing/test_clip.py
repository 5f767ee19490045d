"""A clip is tracked in one pass, within bounds, and knows what neutrals it has."""

from collections.abc import Iterator

import numpy as np
import pytest
from gemheads.models.crossing import clip as clips
from gemheads.models.crossing.album import SIDE, Album, face_square
from gemheads.models.crossing.clip import Clip, ShortClip, UnseenDriver, track_clip
from gemheads.models.crossing.loop import echo
from gemheads.models.crossing.mirror import LOOKS
from gemheads.models.driver.answer import Express
from gemheads.models.driver.face import LOOKS_APART, FaceObservation
from gemheads.render.arrays import Image
from pixelface import PixelTracker, painted

from .conftest import RATE, PaintedMirror, performed


def test_every_nth_frame_of_so_many_seconds_is_taken() -> None:
    clip = track_clip(performed(), 3, 1.0)
    np.testing.assert_allclose(clip.times, np.arange(0, RATE + 1, 3) / RATE)
    assert len(clip.readings) == len(clip.pictures) == len(clip.times)
    late = track_clip(((picture, now + 100) for picture, now in performed()), 3, 1.0)
    assert len(late.readings) == len(clip.readings)


def test_frames_without_a_face_are_counted_and_too_few_with_one_are_refused() -> None:
    black = np.zeros((SIDE, SIDE, 3), np.uint8)
    pictures = [(black if i % 5 == 0 else painted(0.1), i / RATE) for i in range(20)]
    clip = track_clip(pictures, 1, 60.0)
    assert clip.lost == 4
    assert len(clip.readings) == 16
    with pytest.raises(UnseenDriver, match="a face in 6 of 8 frames, 8 are needed"):
        track_clip(pictures[:8], 1, 60.0)
    with pytest.raises(ShortClip, match="7 frames are taken, 8 are needed"):
        track_clip(pictures[:7], 1, 60.0)
    with pytest.raises(ShortClip, match="0 frames are taken"):
        track_clip([], 1, 60.0)


def test_a_long_clip_is_read_no_further_than_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clips, "MOST_FRAMES", 10)
    given = 0

    def endless() -> Iterator[tuple[Image, float]]:
        nonlocal given
        while True:
            given += 1
            yield painted(0.1), given / RATE

    clip = track_clip(endless(), 1, 1e9)
    assert len(clip.readings) == 10
    assert given == 11
    assert clip.full
    assert clip.seconds == pytest.approx(9 / RATE)
    assert not track_clip(performed(), 3, 1.0).full


def test_the_neutral_is_at_rest_and_the_others_are_other_moments(clip: Clip) -> None:
    assert clip.neutral_time < 7 / RATE
    assert 1 <= len(clip.others) <= clips.OTHERS
    assert len(set(clip.others.tolist())) == len(clip.others)
    assert clip.neutral_time not in clip.times[clip.others]


def test_pictures_show_the_face_and_come_back(clip: Clip) -> None:
    assert clip.pictures[0].shape == (SIDE, SIDE, 3)
    np.testing.assert_allclose(clip.pictures[3][SIDE // 2, SIDE // 2], painted()[48, 48], atol=8)
    picture = np.zeros((100, 300, 3), np.uint8)
    picture[20:60, 200:240] = (250, 10, 10)
    square = face_square(picture, (200, 20, 240, 60))
    assert square[SIDE // 2, SIDE // 2].tolist() == [250, 10, 10]
    assert square[2, 2].tolist() == [0, 0, 0]
    with pytest.raises(ValueError, match="picture 0 of an album is damaged"):
        Album(np.zeros(9, np.uint8), np.array([9]))[0]


@pytest.mark.parametrize(("every", "looks"), [(1, 1), (3, LOOKS_APART)])
def test_frames_apart_are_looked_at_twice_by_all_trackers(
    monkeypatch: pytest.MonkeyPatch, mirror: PaintedMirror, express: Express, every: int, looks: int
) -> None:
    """A face is looked for where it was, and by then it has gone further than that: the driver's and the avatar's."""
    count, track = 0, PixelTracker.track

    def counted(tracker: PixelTracker, picture: Image) -> FaceObservation | None:
        nonlocal count
        count += 1
        return track(tracker, picture)

    monkeypatch.setattr(PixelTracker, "track", counted)
    clip = track_clip(performed(), every, 60.0)
    assert count == looks * len(clip.readings)
    echo(clip, express, mirror)
    assert count == 2 * looks * len(clip.readings) + LOOKS
