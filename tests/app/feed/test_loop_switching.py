"""What goes on when another avatar or another source comes, and what tracks and face data do."""

from dataclasses import replace

import numpy as np
import pytest
from faces import face
from gemheads.app.errors import InputError
from gemheads.app.feed.loop import Loop
from gemheads.app.inputs.source import PoseFrame, WeightsFrame
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.presence import Phase

from ..scripted import GEM, Source, World, avatar, followed, jaw, opened, picture


@pytest.fixture
def world() -> World:
    return followed()


def test_another_avatar_goes_on_with_the_same_expression_at_once(world: World) -> None:
    opened(world)
    other = avatar(1)
    world.loop.cast(other)
    world.turn()
    shot = world.shots[-1]
    assert shot.avatar == other.sha256
    assert other.gem.arkit_weights is not None
    weights = np.linalg.lstsq(other.gem.arkit_weights.T.astype(float), shot.pose.coefficients, rcond=None)[0]
    assert shot.pose.coefficients @ shot.pose.coefficients > 0
    assert np.isfinite(weights).all()


def test_another_source_is_eased_into_though_the_one_before_ended_in_a_scene_without_a_face() -> None:
    world = World(Source(kind="video"))
    world.play(3.0)
    last = jaw(opened(world))[-1]
    world.person.face, elsewhere = None, picture(luma=10)
    elsewhere[:, ::2] = 250
    assert world.play(1 / 30, lambda: world.frame(elsewhere))[-1].pose.cut
    world.person.face = face()
    world.loop.use(world.open, "another video")
    assert jaw(world.play(0.1))[0] > 0.4 * last


def test_an_avatar_whose_regressor_is_broken_is_refused_and_the_one_before_stays(world: World) -> None:
    mapless = avatar(2, arkit=False)
    world.loop.cast(replace(mapless, gem=replace(mapless.gem, regressor=b"no graph")))
    assert world.play(0.1)[-1].avatar == "sha of 0"


def test_serials_rise_and_a_sketch_holds_no_picture(world: World) -> None:
    assert np.diff([shot.serial for shot in world.shots]).tolist() == [1] * (len(world.shots) - 1)
    shot = world.shots[-1]
    assert shot.sketch is not None
    assert shot.sketch.shape == (478, 2)
    assert shot.observed is not None
    assert shot.observed.picture_size == (640, 480)
    assert set(shot.stages) == {"read", "track", "express"}


def test_a_track_is_played_exactly_and_only_by_its_avatar() -> None:
    world = World(Source("track"))
    k = (GEM.rest_coefficients + GEM.sigma).astype(np.float32)
    pose = Pose(k, np.float32([0, 0.1, 0]), translation=np.float32([0.01, 0, 0]))
    shots = world.play(0.5, lambda: PoseFrame(pose, "sha of 0", world.clock.now))
    assert shots[-1].pose.coefficients.tolist() == k.tolist()
    assert shots[-1].pose.translation.tolist() == pose.translation.tolist()
    assert world.phase == "tracking"
    shots = world.play(1.0, lambda: PoseFrame(pose, "another", world.clock.now))
    assert np.abs(shots[-1].pose.translation).max() < 1e-6
    assert "another avatar" in world.loop.health.message
    assert shots[-1].pose.phase is Phase.IDLE


def test_an_avatar_that_comes_back_does_what_its_track_says_at_once() -> None:
    world = World(Source("track"))
    k = (GEM.rest_coefficients + GEM.sigma).astype(np.float32)
    given = PoseFrame(Pose(k, np.float32([0, 0.1, 0])), "sha of 0", world.clock.now)
    world.play(0.2, lambda: given)
    for seed, coefficients in ((1, None), (0, k)):
        world.loop.cast(avatar(seed))
        shot = world.loop.shots.take()
        assert shot is not None
        assert shot.avatar == f"sha of {seed}"
        assert coefficients is None or shot.pose.coefficients.tolist() == coefficients.tolist()


def test_weights_move_any_avatar_and_silence_is_told() -> None:
    from gemheads.models import arkit

    world = World(Source("weights", name="osc on 127.0.0.1:39539"))
    world.silence(2.0)
    assert world.phase == "searching"
    assert "Nothing comes in" in world.loop.health.message
    world.loop.use(world.open, world.source.name)  # anew, and nothing is late yet
    world.silence(0.5)
    assert "Nothing comes in" not in world.loop.health.message
    world.silence(2.0)
    assert "Nothing comes in" in world.loop.health.message
    weights = np.zeros(52, np.float32)
    weights[arkit.NAMES.index("jawOpen")] = 0.8
    turn = np.float32([0, 0.2, 0])
    shots = world.play(1.5, lambda: WeightsFrame(weights, turn, world.clock.now))
    assert jaw(shots)[-1] == pytest.approx(0.8, abs=0.03)
    assert shots[-1].pose.turn == pytest.approx([0, 0.2, 0], abs=0.01)
    broken = np.full(52, np.nan, np.float32)
    world.play(0.1, lambda: WeightsFrame(broken, turn, world.clock.now))
    assert world.loop.health.rejected == 3
    world.silence(2.0)
    assert world.phase == "stalled"
    assert world.shots[-1].pose.phase is Phase.IDLE


def test_an_avatar_that_no_face_drives_plays_its_track_and_says_what_faces_lack(world: World) -> None:
    unfaced = avatar(2, arkit=False)
    world.loop.cast(unfaced)
    looks = world.person.looks
    shots = world.play(0.5)
    assert {shot.avatar for shot in shots} == {"sha of 2"}
    assert world.person.looks == looks
    assert "has no regressor" in world.loop.health.message
    world.loop.use(world.open, "a track")
    k = (unfaced.gem.rest_coefficients + unfaced.gem.sigma).astype(np.float32)
    shots = world.play(0.5, lambda: PoseFrame(Pose(k, np.zeros(3, np.float32)), "sha of 2", world.clock.now))
    assert shots[-1].pose.coefficients.tolist() == k.tolist()
    assert world.loop.health.message == ""


def test_a_loop_needs_an_avatar_whose_regressor_is_whole() -> None:
    mapless = avatar(arkit=False)
    with pytest.raises(InputError, match="ARKit"):
        Loop(replace(mapless, gem=replace(mapless.gem, regressor=b"no graph")), lambda: World().person)
