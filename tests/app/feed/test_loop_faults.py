"""What goes wrong with a source, the tracker or the machine, and what the loop does then."""

import numpy as np
import pytest
from faces import face
from gemheads.app.errors import InputError
from gemheads.app.inputs.source import SourceLost
from gemheads.app.inputs.transport import Playhead
from gemheads.app.performing.presence import Phase
from gemheads.app.person.hints import SENTENCES
from gemheads.app.person.tuning import Tuning
from gemheads.models.driver.networks import NetworkError

from ..scripted import Source, World, avatar, followed, jaw, opened, picture, unplugged


@pytest.fixture
def world() -> World:
    return followed()


def test_a_slow_camera_is_told(world: World) -> None:
    world.play(5.0, rate=8)
    assert world.loop.health.rate == pytest.approx(8, abs=1)
    assert SENTENCES["slow"] in world.loop.health.hints


# the camera goes, hangs, freezes, sends garbage


def test_an_unplugged_camera_is_sought_by_itself_ever_more_patiently_and_used_again(world: World) -> None:
    opened(world)
    world.opened.clear()
    world.source.lost, world.refusal = unplugged(), SourceLost("It is not connected.", "Plug it in.", True)
    gone = world.clock.now
    shots = world.silence(20.0)
    assert world.phase == "stalled"
    assert (world.loop.health.message, world.loop.health.cure) == ("It is not connected.", "Plug it in.")
    waits = np.diff([gone, *world.opened])
    assert waits[:6] == pytest.approx([0.5, 1, 2, 4, 5, 5], abs=0.12)
    assert shots[-1].pose.phase is Phase.IDLE
    assert len(shots) > 500  # the avatar lives on
    world.source.lost = world.refusal = None
    world.play(5.5)
    assert world.phase == "tracking"
    assert world.loop.health.message == ""


def test_a_camera_that_sends_nothing_has_stalled_after_a_second(world: World) -> None:
    world.silence(0.9)
    assert world.phase != "stalled"
    world.silence(0.3)
    assert world.phase == "stalled"
    assert "sends no pictures" in world.loop.health.message
    world.silence(1.0)
    assert world.source.closed >= 1
    world.play(0.5)
    assert world.phase == "tracking"


def test_the_same_picture_over_and_over_is_no_camera(world: World) -> None:
    frozen = picture(3)
    looks = world.person.looks
    world.play(0.4, lambda: world.frame(frozen))
    assert world.phase == "tracking"
    shots = world.play(2.0, lambda: world.frame(frozen))
    assert world.phase == "stalled"
    assert "same picture" in world.loop.health.message
    assert shots[-1].pose.phase is Phase.IDLE
    assert world.person.looks - looks < 60
    world.play(0.3)
    assert world.phase == "tracking"


def test_a_paused_video_and_a_still_picture_have_not_stalled() -> None:
    source = Source("video")
    source.transport = playhead = Playhead(10.0, 1 / 30)
    world = World(source)
    last = world.play(3.0)[-1]
    playhead.pause()
    assert world.silence(5.0) == []  # the window keeps what it shows
    assert world.phase == "tracking"
    world.loop.cast(avatar(1))
    world.turn()
    assert world.shots[-1].avatar == "sha of 1"
    assert world.shots[-1].pose.phase is last.pose.phase
    still = World(Source("pictures"))
    still.play(3.0, lambda: still.frame(picture(1)))
    assert still.phase == "tracking"


def test_garbage_is_counted_and_changes_nothing(world: World) -> None:
    opened(world)
    garbage = [None, "text", np.zeros((0, 0, 3), np.uint8), np.zeros((48, 64), np.uint8), np.zeros((48, 64, 3))]

    def make() -> object:
        return world.frame(garbage[world.count % 5]) if garbage[world.count % 5] is not None else object()

    world.play(0.2, make)
    assert world.loop.health.rejected == 6
    assert world.phase == "tracking"
    world.play(1.2, make)
    assert world.phase == "stalled"
    world.play(0.5)
    assert world.phase == "tracking"


def test_in_pictures_of_another_size_the_followed_face_is_followed_on(world: World) -> None:
    """A tracker knows where it must be there; searched anew it might be another one."""
    opened(world)
    resets, box = world.person.resets, world.loop.acting._memory.box
    shots = world.play(0.5, lambda: world.frame(picture(world.count, (128, 96))))
    assert world.person.resets == resets
    assert world.loop.acting._memory.box == box
    assert world.phase == "tracking"
    assert jaw(shots) == pytest.approx([0.575] * len(shots), abs=0.05)


def test_what_could_not_be_done_is_told_for_some_seconds(world: World) -> None:
    world.loop.ask(lambda: 1 / 0)
    world.play(2.0)
    assert world.loop.health.message.startswith("That could not be done")
    world.play(3.0)
    assert world.loop.health.message == ""


def test_nothing_that_was_counted_or_said_of_a_source_is_said_of_the_next(world: World) -> None:
    """Nor is what made its driver hard to read smoothed any more, nor what its expressions took off the turn."""
    cutoff = world.loop.acting._actor.expression_filter.min_cutoff_hz
    world.play(2.0, lambda: world.frame(picture(world.count, luma=20)))
    assert world.loop.acting._actor.expression_filter.min_cutoff_hz < cutoff
    world.person.face = face(jaw=float("nan"))
    world.play(0.5)
    assert world.loop.health.rejected == 15
    world.loop.use(world.open, "the next")
    world.person.face = face()
    world.play(0.1)
    assert world.loop.acting._actor.expression_filter.min_cutoff_hz == cutoff
    assert world.loop.health.rejected == 0


def test_a_camera_is_not_slow_because_it_has_just_begun() -> None:
    world = World()
    world.play(0.3)
    assert world.loop.health.rate == pytest.approx(30, abs=2)


def test_nan_keeps_the_last_good_expression_and_is_counted(world: World) -> None:
    last = opened(world)[-1]
    world.person.face = face(jaw=float("nan"))
    shots = world.play(0.5)
    assert jaw(shots) == pytest.approx([jaw([last])[0]] * len(shots), abs=1e-6)
    assert world.loop.health.rejected == 15


def test_nan_from_the_first_frame_on_does_not_poison_the_neutral() -> None:
    world = World()
    world.person.face = face(jaw=float("nan"))
    world.play(1.0)
    assert world.loop.health.rejected == 30
    world.person.face = face()
    world.play(2.5)
    assert jaw(opened(world))[-1] == pytest.approx(0.575, abs=0.05)


def test_a_video_without_a_face_says_so() -> None:
    world = World(Source("video"))
    world.person.face = None
    world.play(1.0)
    assert world.phase == "searching"
    assert "No face" in world.loop.health.message


def test_a_tracker_that_fails_is_told_and_the_avatar_lives_on(world: World) -> None:
    world.person.broken = NetworkError("a network is missing")
    shots = world.play(2.0)
    assert "a network is missing" in world.loop.health.message
    assert shots[-1].pose.phase is Phase.IDLE
    world.person.broken = None
    world.play(0.5)
    assert (world.phase, world.loop.health.message) == ("tracking", "")


def test_a_slow_stage_costs_frames_but_never_time(world: World) -> None:
    world.person.secs = 0.2
    shots = world.play(0.5, rate=30.0)
    assert all(shot.ready - shot.delivered < 0.25 for shot in shots)
    assert shots[-1].stages["track"] == pytest.approx(0.2)
    assert world.phase == "tracking"


def test_half_the_work_on_a_slow_machine(world: World) -> None:
    world.loop.acting.tune(Tuning(detector_every=2))
    looks = world.person.looks
    shots = world.play(1.0)
    assert world.person.looks - looks == 15
    assert len(shots) == 15


# opening


def test_a_camera_that_is_refused_says_why_and_what_to_do() -> None:
    world = World()
    world.refusal = SourceLost("The camera cannot be opened.", "Close other programs.", True)
    world.loop.use(world.open, "the camera")
    shots = world.silence(1.0)
    assert world.phase == "stalled"
    assert (world.loop.health.message, world.loop.health.cure) == (
        "The camera cannot be opened.",
        "Close other programs.",
    )
    assert shots


def test_a_file_that_is_none_is_not_tried_again() -> None:
    world = World()
    world.refusal = InputError("clip.mp4: no such file; check the path")
    world.loop.use(world.open, "clip.mp4")
    tries = len(world.opened)
    world.silence(10.0)
    assert world.phase == "no source"
    assert "no such file" in world.loop.health.message
    assert len(world.opened) == tries


def test_a_camera_that_hangs_while_it_opens_keeps_nobody_waiting() -> None:
    world = World()
    world.hangs = True
    hanging = Source(name="hanging")
    world.loop.use(lambda: hanging, "hanging")
    assert len(world.silence(6.0)) > 150
    assert world.phase == "opening"
    assert "takes long" in world.loop.health.message
    world.hangs = False
    world.loop.use(world.open, "the camera")
    closed = world.source.closed
    world.play(1.0)
    assert world.phase == "tracking"
    world.works[0]()  # now it opens after all
    assert hanging.closed == 1
    assert world.source.closed == closed


def test_a_source_that_fails_in_its_own_way_does_not_take_the_loop_with_it(world: World) -> None:
    world.source.lost = ZeroDivisionError("a driver's own")
    world.silence(0.2)
    assert world.phase == "stalled"
    world.source.lost = None
    world.play(2.0)
    assert world.phase == "tracking"


# neutral
