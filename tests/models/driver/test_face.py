"""Following a face through real pictures."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from gemheads.models.driver.detector import LEAST_FACE, overlap
from gemheads.models.driver.face import FaceObservation, FaceTracker, looked
from gemheads.models.driver.features import head_rotation
from gemheads.models.driver.mirroring import mirrored_scores
from numpy.typing import NDArray

Frames = list[NDArray[np.uint8]]


def seen(face: FaceObservation | None) -> FaceObservation:
    assert face is not None
    return face


def test_a_face_is_followed_and_the_detector_rests(tracker: FaceTracker, frames: Frames) -> None:
    faces = [seen(tracker.track(frame)) for frame in frames[:12]]
    assert [face.faces for face in faces] == [1] + [None] * 11
    for face, frame in zip(faces, frames, strict=False):
        assert face.presence > 0.9
        assert face.image_size == (frame.shape[1], frame.shape[0])
        assert face.scores.shape == (52,)
        assert ((face.scores >= 0) & (face.scores <= 1)).all()
        assert face.landmarks_px.shape == (478, 3)
        assert face.metric_irises.shape == (10, 3)
        assert np.isfinite(face.metric_mesh).all()
        left, top, right, bottom = face.box_px
        assert 0 < left < right < frame.shape[1]
        assert 0 < top < bottom < frame.shape[0] * 1.05


def test_how_sharp_a_face_is_depends_neither_on_the_light_nor_on_grain(tracker: FaceTracker, frames: Frames) -> None:
    def sharpness(picture: NDArray[np.floating]) -> float:
        tracker.reset()
        return seen(tracker.track(np.clip(picture, 0, 255).astype(np.uint8))).sharpness

    bright = frames[0].astype(float)
    grain = np.random.default_rng(0).normal(0, 10, bright.shape)
    assert sharpness(0.4 * bright) == pytest.approx(sharpness(bright), rel=0.2)
    assert sharpness(bright + grain) < 1.5 * sharpness(bright)
    assert sharpness(cv2.GaussianBlur(bright, (0, 0), bright.shape[1] / 100)) < 0.5 * sharpness(bright)


def test_the_same_pictures_give_the_same_numbers(frames: Frames) -> None:
    runs = [
        [seen(tracker.track(frame)).landmarks_px for frame in frames[:3]] for tracker in (FaceTracker(), FaceTracker())
    ]
    np.testing.assert_array_equal(runs[0], runs[1])


def test_a_face_just_detected_is_read_as_it_is_a_few_looks_later(
    monkeypatch: pytest.MonkeyPatch, tracker: FaceTracker, frames: Frames
) -> None:
    """The crop around the detector's guess shifts what is read many times as much."""

    def off() -> float:
        shifts: list[float] = []
        for frame in frames[::8]:
            tracker.reset()
            first = seen(tracker.track(frame))
            assert first.faces == 1
            shifts.append(float(np.abs(first.scores - seen(looked(tracker, frame, 3)).scores).mean()))
        return float(np.mean(shifts))

    settled = off()
    monkeypatch.setattr("gemheads.models.driver.face.SETTLING", 0)
    assert settled < 0.25 * off()


def test_a_face_that_moves_is_read_as_one_that_keeps_still(frames: Frames) -> None:
    """With one look it is cut out where it was a moment ago, and read askew."""
    box = seen(FaceTracker().track(frames[0])).box_px
    step = round(0.03 * (box[3] - box[1]))

    def off(tracker: FaceTracker) -> float:
        shifts: list[float] = []
        for frame in frames[::8]:
            tracker.reset()
            tracker.track(frame)
            moved = np.roll(frame, (step, -step), (0, 1))
            shifts.append(
                float(np.abs(seen(tracker.track(moved)).scores - seen(looked(tracker, moved, 3)).scores).mean())
            )
        return float(np.mean(shifts))

    assert off(FaceTracker()) < 0.5 * off(FaceTracker(moved=np.inf))


def test_a_face_is_looked_at_twice_only_where_it_has_moved(
    monkeypatch: pytest.MonkeyPatch, tracker: FaceTracker, frames: Frames
) -> None:
    looked(tracker, frames[0], 3)
    looks: list[object] = []
    look = FaceTracker._look
    monkeypatch.setattr(FaceTracker, "_look", lambda *given: looks.append(given) or look(*given))
    tracker.track(frames[0])
    assert len(looks) == 1
    tracker.track(np.roll(frames[0], 8, 1))
    assert len(looks) == 3


def test_nobody_is_none_and_the_face_comes_back(tracker: FaceTracker, frames: Frames) -> None:
    assert seen(tracker.track(frames[0])).faces == 1
    assert tracker.track(np.full_like(frames[0], 127)) is None
    assert tracker.track(np.random.default_rng(0).integers(0, 255, frames[0].shape, np.uint8)) is None
    assert seen(tracker.track(frames[1])).faces == 1


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (720, 1280)])
def test_a_face_is_seen_from_an_eighth_of_the_longer_side_on(
    tracker: FaceTracker, frames: Frames, width: int, height: int
) -> None:
    top, bottom = seen(tracker.track(frames[0])).box_px[1::2]
    scale = LEAST_FACE * max(width, height) / (bottom - top)
    small = cv2.resize(frames[0], None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    for left in (0, (width - small.shape[1]) // 2):
        picture = np.full((height, width, 3), 120, np.uint8)
        picture[200 : 200 + small.shape[0], left : left + small.shape[1]] = small
        tracker.reset()
        seen(tracker.track(picture))


def test_a_face_that_jumps_is_found_in_the_same_picture(tracker: FaceTracker, frames: Frames) -> None:
    frame = frames[0]
    tracker.track(frame)
    moved = np.concatenate([np.zeros_like(frame), frame], axis=1)
    face = seen(tracker.track(moved))
    assert face.faces == 1
    assert face.box_px[0] > frame.shape[1]


@pytest.mark.parametrize(("across", "down"), [(0.5, 0.5), (2.0, 2.0), (1.0, 0.8)])
def test_a_face_is_followed_while_the_picture_changes_its_size(
    tracker: FaceTracker, frames: Frames, across: float, down: float
) -> None:
    """Meetings and browsers record larger and smaller as the network allows."""
    before = seen(tracker.track(frames[0]))
    scaled = cv2.resize(frames[1], None, fx=across, fy=down, interpolation=cv2.INTER_AREA)
    face = seen(tracker.track(np.asarray(scaled, np.uint8), before.box_px))
    assert face.faces is None  # it was not looked for
    here = np.divide(face.box_px, [across, down] * 2)
    assert overlap(tuple(here), before.box_px) > 0.8
    assert seen(tracker.track(frames[2], face.box_px)).faces is None


def test_one_of_two_faces_is_locked_and_found_again(tracker: FaceTracker, frames: Frames) -> None:
    both = np.concatenate([frames[0], frames[0][:, ::-1]], axis=1)
    detections = sorted(tracker.detect(both), key=lambda face: face.box_px[0])
    assert len(detections) == 2
    for chosen in detections:
        tracker.lock(chosen)
        assert overlap(seen(tracker.track(both)).box_px, chosen.box_px) > 0.3
        assert tracker.track(np.zeros_like(both)) is None
        again = seen(tracker.track(both))
        assert again.faces == 2
        assert overlap(again.box_px, chosen.box_px) > 0.3


def test_a_lock_holds_while_both_faces_come_and_go(tracker: FaceTracker, frames: Frames) -> None:
    left, right = frames[0], frames[0][:, ::-1]
    nobody = np.full_like(left, 127)
    first = seen(tracker.track(np.concatenate([left, nobody], axis=1)))
    box = first.box_px
    for pair, there in (
        ((left, right), True),
        ((nobody, right), False),  # the other one alone
        ((nobody, right), False),
        ((left, right), True),
        ((left, nobody), True),
        ((nobody, nobody), False),
        ((left, right), True),
    ):
        face = tracker.track(np.concatenate(pair, axis=1), box)
        assert (face is not None) is there
        assert face is None or overlap(face.box_px, box) > 0.8
    assert seen(tracker.track(np.concatenate([nobody, right], axis=1))).box_px[0] > left.shape[1]  # the lock is off


def test_a_face_of_a_clip_is_never_taken_for_another(tracker: FaceTracker, frames: Frames) -> None:
    """Not even at an eighth of its frames, when it moves eight times as fast."""
    for stride in (1, 8):
        box = None
        for frame in frames[::stride]:
            box = seen(tracker.track(frame, box)).box_px


def test_a_face_in_a_mirror_is_read_as_the_same_with_left_and_right_swapped(frames: Frames) -> None:
    frame = frames[len(frames) // 2]
    pictures = (frame, np.ascontiguousarray(frame[:, ::-1]))
    plain, in_mirror = (seen(looked(FaceTracker(), picture, 4)) for picture in pictures)
    assert plain.scores.max() > 0.1
    np.testing.assert_allclose(plain.scores, mirrored_scores(in_mirror.scores), atol=0.01)
    (pitch, yaw, roll), flipped = head_rotation(plain), head_rotation(in_mirror)
    np.testing.assert_allclose([pitch, -yaw, -roll], flipped, atol=np.radians(0.1))


def test_scores_do_not_mind_a_tilted_camera(frames: Frames) -> None:
    quarter = [seen(FaceTracker().track(np.ascontiguousarray(np.rot90(frames[0], k)))) for k in (0, 1)]
    assert np.abs(quarter[0].scores - quarter[1].scores).mean() < 0.03
    roll = head_rotation(quarter[1])[2] - head_rotation(quarter[0])[2]
    assert np.degrees(roll) == pytest.approx(90, abs=5)


@pytest.mark.parametrize(
    ("image", "said"),
    [
        (np.zeros((64, 64), np.uint8), r"\[64, 64\] of uint8"),
        (np.zeros((64, 64, 4), np.uint8), r"\[64, 64, 4\]"),
        (np.zeros((64, 64, 3), np.float32), "float32"),
        (np.zeros((8, 64, 3), np.uint8), "64x8"),
        (np.zeros((0, 0, 3), np.uint8), "0x0"),
        ([[1, 2, 3]], "list"),
    ],
)
def test_what_is_no_image_is_refused(tracker: FaceTracker, image: object, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        tracker.track(image)  # pyright: ignore[reportArgumentType]


def test_a_view_of_an_image_is_an_image(tracker: FaceTracker, frames: Frames) -> None:
    flipped_twice = frames[0][:, ::-1].copy()[:, ::-1]
    assert not flipped_twice.flags.c_contiguous
    assert tracker.track(flipped_twice) is not None


def test_a_locked_speck_is_no_face(tracker: FaceTracker, frames: Frames) -> None:
    face = tracker.detect(frames[0])[0]
    tracker.lock(replace(face, region=replace(face.region, size=0.0)))
    assert seen(tracker.track(frames[0])).faces == 1  # found by the detector instead
