from dataclasses import replace

import numpy as np
import pytest
from gemheads.app.files.video import VideoFile
from gemheads.app.library import DEMO_CLIP, find_avatar
from gemheads.app.performing.casting import Avatar, open_avatar
from gemheads.app.performing.shots import Observed
from gemheads.app.person.coach import coach
from gemheads.app.person.restface import (
    COLLECT_SECS,
    COUNTDOWN_SECS,
    FEWEST,
    MOST_LEARNED_RESIDUAL,
    MOST_RESIDUAL,
    RestSession,
    judge,
    step,
)
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.features import BLOCKS, feature_vector, head_rotation
from gemheads.models.driver.measures import MEASURES

RATE = 30.0
STILL, BLINKING, TALKING = slice(0, 26), slice(26, 34), slice(62, 140)
"""Frames of the demo clip: a face at rest, one blink, and what follows."""


@pytest.fixture(scope="module")
def clip() -> list[Observed]:
    """What the tracker sees in the demo clip, to its 140th frame."""
    tracker, seen = FaceTracker(), []
    for frame in VideoFile(DEMO_CLIP).frames():
        face = tracker.track(frame.rgb)
        assert face is not None
        seen.append(
            Observed(
                features=feature_vector(face),
                rotation=head_rotation(face),
                box_px=face.box_px,
                picture_size=face.image_size,
                luma=0.5,
                surround=0.5,
                sharpness=face.sharpness,
                presence=face.presence,
                faces=1,
            )
        )
        if len(seen) == TALKING.stop:
            break
    return seen


@pytest.fixture(scope="module")
def avatar() -> Avatar:
    return open_avatar(find_avatar("mara"))


def played(pictures: list[Observed], session: RestSession | None = None, rate: float = RATE) -> RestSession:
    """A session that is shown these pictures, one after the other, from its countdown's end."""
    ready = session or RestSession(phase="collecting", since=0.0)
    for number, picture in enumerate(pictures):
        ready = step(ready, picture, rate, number / rate)
    return ready


def for_two_secs(pictures: list[Observed]) -> list[Observed]:
    """Forward and back again until two seconds are full: a face that stays as it is, each picture another one."""
    there_and_back = [*pictures, *pictures[::-1]]
    return [replace(there_and_back[number % len(there_and_back)]) for number in range(62)]


def test_the_coach_is_content_with_a_face_at_rest(clip: list[Observed]) -> None:
    assert coach(clip[0], RATE).green


def with_measure(observed: Observed, name: str, value: float) -> Observed:
    features = observed.features.copy()
    features[BLOCKS["measures"].start + MEASURES.index(name)] = value
    return replace(observed, features=features)


def test_each_fault_has_its_one_sentence(clip: list[Observed]) -> None:
    good = clip[0]
    degrees = np.pi / 180
    faults = {
        "Be alone": replace(good, faces=2),
        "Come closer": replace(good, box_px=(200, 200, 280, 320)),
        "Move back": replace(good, box_px=(0, 0, 500, 400)),
        "to your right": replace(good, rotation=np.array([0, 13 * degrees, 0])),
        "to your left": replace(good, rotation=np.array([0, -13 * degrees, 0])),
        "Lift your chin": replace(good, rotation=np.array([13 * degrees, 0, 0])),
        "Lower your chin": replace(good, rotation=np.array([-13 * degrees, 0, 0])),
        "upright": replace(good, rotation=np.array([0, 0, 9 * degrees])),
        "Close your mouth": with_measure(good, "lip_gap", 0.9),
        "too dark": replace(good, luma=0.1, surround=0.1),
        "too bright": replace(good, luma=0.99),
        "from behind": replace(good, luma=0.25, surround=0.8),
        "blurred": replace(good, sharpness=5e-5),
        "cover your face": replace(good, presence=0.6),
    }
    for words, picture in faults.items():
        (sentence,) = coach(picture, RATE).sentences
        assert words in sentence
    assert "slow" in coach(good, 8.0).sentences[0]
    assert "sees your face" in coach(None, RATE).sentences[0]


def test_a_whole_session_coaches_counts_down_and_collects(clip: list[Observed], avatar: Avatar) -> None:
    session, now, phases = RestSession(), 0.0, []
    pictures = for_two_secs(clip[STILL]) * 4
    for number, picture in enumerate(pictures):
        now = number / RATE
        session = step(session, None if now < 0.5 else picture, RATE, now)
        phases.append(session.phase)
        if session.phase == "done":
            break
    assert list(dict.fromkeys(phases)) == ["coaching", "countdown", "collecting", "done"]
    assert now == pytest.approx(0.5 + COUNTDOWN_SECS + COLLECT_SECS, abs=0.15)
    assert phases.count("countdown") == pytest.approx(COUNTDOWN_SECS * RATE, abs=2)
    resting = judge(session, avatar)
    assert resting is not None
    assert resting.accepted, resting.why
    assert resting.residual < MOST_RESIDUAL / 4
    true = np.median([picture.features for picture in clip[STILL]], axis=0)
    assert np.abs(resting.choice.features - true).max() < 0.5
    assert np.degrees(resting.choice.rotation) == pytest.approx(np.degrees(clip[10].rotation), abs=1.0)
    assert 0 < resting.noise.mean() < 0.1


def test_the_countdown_says_its_numbers_and_stops_for_a_turned_head(clip: list[Observed]) -> None:
    turned = replace(clip[0], rotation=np.array([0, 0.5, 0]))
    session = step(RestSession(), clip[0], RATE, 0.0)
    assert session.message.endswith(": 3")
    session = step(session, clip[1], RATE, 1.5)
    assert session.message.endswith(": 2")
    session = step(session, turned, RATE, 1.6)
    assert session.phase == "countdown"  # a moment is forgiven
    session = step(session, turned, RATE, 2.0)
    assert session.phase == "coaching"
    assert "to your right" in session.message


def test_blinks_do_not_count(clip: list[Observed], avatar: Avatar) -> None:
    blinking = [*for_two_secs(clip[STILL])[:20], *clip[BLINKING], *for_two_secs(clip[STILL])[:34]]
    without, within = judge(played(for_two_secs(clip[STILL])), avatar), judge(played(blinking), avatar)
    assert without is not None
    assert within is not None
    assert within.accepted
    assert np.abs(within.choice.features - without.choice.features).max() < 0.4
    lids = BLOCKS["measures"].start + MEASURES.index("left_lid_gap")
    assert within.choice.features[lids] > 0.85 * clip[0].features[lids]
    assert ", 0 blinks" not in within.choice.reason


def test_outliers_do_not_count(clip: list[Observed], avatar: Avatar) -> None:
    jumped = for_two_secs(clip[STILL])
    for number in (7, 21, 22, 40):  # the landmarks jump for a moment
        features = jumped[number].features.copy()
        features[BLOCKS["mesh"]] += 3.0
        jumped[number] = replace(jumped[number], features=features)
    calm, tossed = judge(played(for_two_secs(clip[STILL])), avatar), judge(played(jumped), avatar)
    assert calm is not None
    assert tossed is not None
    assert tossed.accepted
    assert np.abs(tossed.choice.features - calm.choice.features).max() < 0.1
    left_out = [int(resting.choice.reason.split(" outliers")[0].split()[-1]) for resting in (calm, tossed)]
    assert left_out[1] == left_out[0] + 4


def talking(clip: list[Observed]) -> list[Observed]:
    """With lips together and the head still, so that the coach lets it pass."""
    return [with_measure(replace(picture, rotation=clip[0].rotation), "lip_gap", 0.1) for picture in clip[TALKING]]


@pytest.mark.parametrize("name", ["mara", "theo", "jonah"])
def test_a_talking_face_is_refused_and_told_why(clip: list[Observed], name: str) -> None:
    shown = open_avatar(find_avatar(name))
    moved, calm = (judge(played(seen), shown) for seen in (talking(clip), for_two_secs(clip[STILL])))
    assert moved is not None
    assert calm is not None
    assert not moved.accepted
    assert "your face moved" in moved.why
    assert f"allowed {MOST_RESIDUAL}" in moved.why
    assert moved.residual > 1.4 * MOST_RESIDUAL
    assert calm.accepted
    assert moved.residual > 8 * calm.residual


def test_an_avatar_that_knows_no_shapes_judges_by_its_regressor(clip: list[Observed], avatar: Avatar) -> None:
    shapeless = replace(avatar, gem=replace(avatar.gem, arkit_weights=None))
    moved, calm = (judge(played(seen), shapeless) for seen in (talking(clip), for_two_secs(clip[STILL])))
    assert moved is not None
    assert calm is not None
    assert not moved.accepted
    assert f"allowed {MOST_LEARNED_RESIDUAL}" in moved.why
    assert moved.residual > 1.4 * MOST_LEARNED_RESIDUAL
    assert calm.accepted
    assert moved.residual > 8 * calm.residual


def test_a_face_that_leaves_gives_nothing(clip: list[Observed], avatar: Avatar) -> None:
    session = played([*clip[:8]])
    for number in range(120):
        session = step(session, None, RATE, 0.3 + number / RATE)
    assert session.phase == "done"
    assert judge(session, avatar) is None


def test_the_same_picture_is_not_counted_twice(clip: list[Observed]) -> None:
    """The window runs at 60 pictures a second, the camera at 30."""
    session = RestSession(phase="collecting", since=0.0)
    for number in range(60):
        session = step(session, clip[number // 2 % 26], RATE, number / 60)
    assert len(session.samples) == 30


def test_a_slow_camera_gets_more_time(clip: list[Observed]) -> None:
    pictures = for_two_secs(clip[STILL])[:FEWEST]
    assert played(pictures, rate=13.0).phase == "collecting"
    session = RestSession(phase="collecting", since=0.0)
    for number, picture in enumerate(for_two_secs(clip[STILL])):
        session = step(session, picture, 12.0, number / 6)  # half of what it promised arrives
        if session.phase == "done":
            break
    assert len(session.samples) == FEWEST
