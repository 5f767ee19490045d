"""What a face does, and what the loop makes of it: held, at rest, locked, turned, at another avatar."""

from dataclasses import replace

import numpy as np
import pytest
from faces import face
from gemheads.app.inputs.source import WeightsFrame
from gemheads.app.inputs.transport import Playhead
from gemheads.app.performing.presence import Phase
from gemheads.app.person.hints import SENTENCES, Sign
from gemheads.app.person.tuning import Tuning
from gemheads.models.driver.neutral import neutral_of
from gemheads.models.driver.smoothing import Smoothed

from ..scripted import Source, World, followed, jaw, opened, picture


@pytest.fixture
def world() -> World:
    return followed()


def test_a_face_that_is_away_for_a_moment_is_held(world: World) -> None:
    last = opened(world)[-1]
    world.person.face = None
    shots = world.play(0.36)
    assert world.phase == "hold"
    assert all(shot.pose.phase is Phase.HOLD for shot in shots)
    assert jaw(shots) == pytest.approx([jaw([last])[0]] * len(shots), abs=1e-4)
    assert world.loop.health.message == ""


def test_a_face_that_is_away_longer_lets_the_avatar_rest_and_return_softly(world: World) -> None:
    opened(world)
    world.person.face = None
    shots = world.play(1.4)
    assert world.phase == "idle"
    assert world.loop.health.message == "Looking for you."
    assert "within a metre" in world.loop.health.cure  # a face further away would not be found
    assert jaw(shots)[-1] == pytest.approx(0, abs=0.02)
    assert np.abs(np.diff(jaw(shots))).max() < 0.1
    back = opened(world, 0.6)
    assert jaw(back)[0] < 0.2
    assert jaw(back)[10] == pytest.approx(0.575, abs=0.06)
    assert world.phase == "tracking"


def test_an_avatar_nobody_drives_breathes_and_blinks() -> None:
    world = World()
    world.loop.use(None, "")
    shots = world.silence(6.0)
    assert world.phase == "no source"
    assert len(shots) == pytest.approx(180, abs=15)
    assert np.ptp([shot.pose.turn[0] for shot in shots]) > 0.005
    assert np.ptp([shot.pose.coefficients for shot in shots], axis=0).max() > 1e-3


# two faces


def test_the_followed_face_stays_followed_and_the_other_gets_a_badge_and_a_key(world: World) -> None:
    left, top, right, bottom = face().box_px
    beside = (left + 300, top, right + 300, bottom)
    world.person.others = [beside]
    shots = world.play(2.0)
    assert shots[-1].pose.faces == 2
    assert world.loop.health.hints == (SENTENCES["two faces"],)
    assert world.person.locked == []
    world.loop.acting.relock()
    world.play(0.1)
    assert world.person.locked == [beside]
    assert not world.loop.health.settled  # another person rests in another way


def test_without_another_face_the_lock_stays(world: World) -> None:
    world.loop.acting.relock()
    world.play(0.1)
    assert world.person.locked == []
    assert world.loop.health.settled


# turned, dark, backlit, blurred, far, slow


def test_between_the_frames_of_a_slow_video_the_avatar_does_what_the_last_one_did() -> None:
    world = World(Source(kind="video"))
    world.play(3.0)
    opened(world)
    for _ in range(4):
        assert world.silence(0.8) == []
        assert jaw(world.play(1 / 30))[0] > 0.4
        assert world.phase == "tracking"


def test_a_frame_that_somebody_steps_to_is_shown_as_it_is(world: World) -> None:
    world.person.face = None
    world.play(2.0)
    acting = world.loop.acting
    world.person.face = face(jaw=0.5)
    there = acting.frame(world.frame(), world.clock.now, live=False, exact=True, rate=None)
    assert there is not None
    assert jaw([there])[0] > 0.4


def test_stepping_where_nobody_is_leaves_the_avatar_idle() -> None:
    world = World()
    world.person.face = None
    world.loop.acting.frame(world.frame(), world.clock.now, live=False, exact=True, rate=None)
    assert np.ptp([shot.pose.turn for shot in world.play(4.0)], 0).max() > 1e-3  # it breathes


def test_a_camera_that_takes_its_time_is_no_empty_chair(world: World) -> None:
    opened(world)
    for _ in range(4):
        world.silence(0.5)
        world.play(1 / 30)
    assert world.silence(0.6) == []
    assert world.phase == "tracking"
    assert world.silence(2.0)[-1].pose.phase is Phase.IDLE


def test_how_far_the_avatars_head_turns_changes_neither_face_nor_hints(world: World) -> None:
    jaws = {}
    for gain in (1.0, 2.0, 0.0):
        world.loop.acting.tune(Tuning(gains={"head": gain}))
        world.person.face = face(jaw=0.5, turn=(0.0, np.radians(25), 0.0))
        shots = world.play(2.5)
        jaws[gain] = jaw(shots)[-1]
        assert shots[-1].pose.turn[1] == pytest.approx(gain * np.radians(25), abs=0.02)
        assert SENTENCES["turned"] not in world.loop.health.hints
    assert jaws[2.0] == pytest.approx(jaws[1.0], abs=0.01) == jaws[0.0]
    world.person.face = face(jaw=0.5, turn=(0.0, np.radians(50), 0.0))
    world.play(2.5)
    assert SENTENCES["turned"] in world.loop.health.hints


def test_a_face_turned_too_far_fades_and_is_told(world: World) -> None:
    before = jaw(opened(world))[-1]
    world.person.face = face(jaw=0.5, turn=(0, np.radians(45), 0))
    shots = world.play(2.0)
    assert jaw(shots)[-1] == pytest.approx(before / 2, rel=0.1)
    assert SENTENCES["turned"] in world.loop.health.hints


@pytest.mark.parametrize(
    ("sign", "change"),
    [
        ("dark", {"luma": 20}),
        ("backlit", {"backlit": True}),
        ("blurred", {"sharpness": 1e-5}),
        ("far", {"high": 60}),
    ],
)
def test_what_makes_a_face_hard_to_read_is_told_and_smoothed(world: World, sign: str, change: dict) -> None:
    seen = face(at=(20, 10))
    landmarks = np.array(seen.landmarks_px)
    landmarks[1, 1] = landmarks[0, 1]
    landmarks[2, 1] += change.get("high", 120)
    seen = replace(seen, landmarks_px=landmarks, sharpness=change.get("sharpness", 0.01))
    world.person.face = seen
    cutoff = world.loop.acting._actor.expression_filter.min_cutoff_hz

    def make() -> object:
        rgb = picture(world.count, (640, 480), change.get("luma", 130))
        if change.get("backlit"):
            rgb[:] = 230
            rgb[10:130, 20:100] = 60
            rgb[301, ::7, 0] = world.count
        return world.frame(rgb)

    world.play(0.3, make)
    assert SENTENCES[sign] not in world.loop.health.hints  # not at the first sign of it
    world.play(1.2, make)
    assert world.loop.health.hints == (SENTENCES[sign],)
    assert world.loop.acting._actor.expression_filter.min_cutoff_hz < cutoff
    world.person.face = face()
    world.play(2.0)
    assert world.loop.health.hints == ()
    assert world.loop.acting._actor.expression_filter.min_cutoff_hz == cutoff


@pytest.mark.parametrize(("sign", "luma"), [("black", 2), ("dark", 25), (None, 130)])
def test_where_nobody_is_seen_the_light_is_told(world: World, sign: Sign | None, luma: int) -> None:
    world.person.face = None
    world.play(2.0, lambda: world.frame(picture(world.count, luma=luma)))
    assert world.phase == "idle"
    assert world.loop.health.hints == (() if sign is None else (SENTENCES[sign],))


def test_the_neutral_is_not_silently_the_first_frame() -> None:
    """Somebody comes in talking: the mouth that is open at first must not count as closed for ever."""
    world = World()
    world.person.face = face(jaw=0.6)
    first = world.play(0.3)
    assert SENTENCES["settling"] not in world.loop.health.hints
    world.person.face = face()
    then = world.play(6.5)
    assert world.loop.health.settled
    assert world.loop.health.neutral
    later = opened(world)
    assert jaw(later)[-1] == pytest.approx(0.575, abs=0.06)
    assert np.abs(np.diff(jaw([*first, *then]))).max() < 0.25  # nothing jerks while it settles


def test_who_never_rests_is_told_what_to_do_until_it_is_done() -> None:
    world = World()
    world.person.face = face(lips_cm=1.0)
    world.play(2.0)
    assert world.loop.health.hints == (SENTENCES["settling"],)
    world.play(20.0)
    assert world.loop.health.settled
    assert world.loop.health.hints == (SENTENCES["makeshift"],)
    world.loop.acting.rest(neutral_of(face(), 0, 0.0, "taken"))
    world.play(2.0)
    assert world.loop.health.hints == ()


def test_who_takes_the_seat_of_somebody_else_is_measured_from_their_own_rest(world: World) -> None:
    world.person.face = None
    world.play(1.5)
    world.person.face = face(turn=(0.15, 0, 0))
    sat_down = world.play(7.0)
    assert sat_down[-1].pose.turn == pytest.approx(np.zeros(3), abs=0.01)
    assert world.loop.health.settled


def test_who_takes_over_beside_the_one_who_left_is_measured_from_their_own_rest(world: World) -> None:
    world.person.face = None
    world.play(0.6)
    world.person.face = face(turn=(0.15, 0, 0), at=(400, 100))
    assert world.play(7.0)[-1].pose.turn == pytest.approx(np.zeros(3), abs=0.01)


def test_who_only_bent_down_keeps_their_neutral(world: World) -> None:
    world.person.face = None
    world.play(0.6)
    assert world.phase == "idle"
    world.person.face = face(turn=(0.15, 0, 0))
    assert world.play(3.0)[-1].pose.turn == pytest.approx([0.15, 0, 0], abs=0.01)
    assert world.loop.health.settled


def test_who_comes_back_talking_is_measured_from_the_rest_that_was_seen_before(world: World) -> None:
    world.person.face = None
    world.play(1.5)
    world.person.face = face(jaw=0.5, lips_cm=1.0)
    assert jaw(world.play(3.0))[-1] > 0.4
    world.play(7.0)
    assert SENTENCES["settling"] in world.loop.health.hints


def test_a_neutral_that_was_taken_outlives_an_empty_chair(world: World) -> None:
    world.loop.acting.rest(neutral_of(face(), 0, 0.0, "taken"))
    world.person.face = None
    world.play(5.0)
    world.person.face = face(turn=(0.15, 0, 0))
    assert world.play(7.0)[-1].pose.turn == pytest.approx([0.15, 0, 0], abs=0.01)
    assert world.loop.health.neutral == "taken"


def test_a_face_that_stands_still_is_looked_at_once() -> None:
    """However often sliders move meanwhile."""
    world = World(Source("video", transport=Playhead(10.0, 1 / 30, clock=lambda: 0.0)))
    world.play(0.3)
    assert world.source.transport is not None
    world.source.transport.pause()
    seen = len(world.loop.acting.source.settling.faces)
    assert seen > 0
    for strength in np.linspace(0, 1, 50):
        world.loop.acting.tune(Tuning(neutral_strength=float(strength)))
        world.loop.changed()
    assert len(world.loop.acting.source.settling.faces) == seen


def test_a_paused_moment_has_nothing_of_the_nod_before_it() -> None:
    world = followed()
    acting = world.loop.acting
    acting._memory = replace(acting._memory, misread=Smoothed(np.array([0.15, 0, 0]), np.zeros(3)))
    acting.begin()
    still = WeightsFrame(np.zeros(52, np.float32), np.zeros(3, np.float32), 0.0)
    assert acting.weights(still, exact=True).pose.turn == pytest.approx(np.zeros(3), abs=1e-6)


def test_a_neutral_that_was_taken_replaces_the_automatic_one(world: World) -> None:
    shots = opened(world)
    assert jaw(shots)[-1] == pytest.approx(0.575, abs=0.05)
    world.loop.acting.rest(neutral_of(face(jaw=0.5), 0, 0.0, "taken"))
    shots = world.play(1.5)
    assert jaw(shots)[-1] == pytest.approx(0, abs=0.03)
    assert np.abs(np.diff(jaw(shots))).max() < 0.15
    assert world.loop.health.neutral == "taken"
    world.loop.acting.tune(Tuning(neutral_strength=0.0))
    assert jaw(world.play(1.5))[-1] == pytest.approx(0.575, abs=0.05)
    world.loop.acting.rest(None)
    world.play(0.1)
    assert not world.loop.health.settled
