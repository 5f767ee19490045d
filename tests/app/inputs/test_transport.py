import numpy as np
import pytest
from gemheads.app.inputs.transport import Playhead

from ..scripted import Clock


@pytest.fixture
def clock() -> Clock:
    return Clock()


def head(clock: Clock, loop: bool = True) -> Playhead:
    return Playhead(2.0, 0.1, loop, clock)


def test_it_runs_by_the_clock_and_in_a_circle(clock: Clock) -> None:
    played = head(clock)
    clock.now += 0.5
    assert played.position == pytest.approx(0.5)
    clock.now += 1.75
    assert played.position == pytest.approx(0.25)
    assert played.jumps == 1
    assert played.playing


def test_without_a_loop_it_stops_at_the_end_and_begins_again_when_asked(clock: Clock) -> None:
    played = head(clock, loop=False)
    clock.now += 5
    assert (played.position, played.playing) == (2.0, False)
    played.play()
    assert (played.position, played.playing) == (0.0, True)


def test_a_pause_keeps_the_place(clock: Clock) -> None:
    played = head(clock)
    clock.now += 0.7
    played.pause()
    clock.now += 30
    assert played.position == pytest.approx(0.7)
    played.play()
    clock.now += 0.1
    assert played.position == pytest.approx(0.8)
    assert played.jumps == 0


def test_steps_pause_and_stay_within(clock: Clock) -> None:
    played = head(clock)
    played.step(3)
    assert (played.playing, played.position) == (False, pytest.approx(0.3))
    played.step(-100)
    assert played.position == 0
    played.step(1000)
    assert played.position == pytest.approx(1.9)


def test_seeking_goes_to_the_nearest_place_there_is(clock: Clock) -> None:
    played = head(clock)
    for wanted, got in ((1.5, 1.5), (-3, 0), (1.0, 1.0), (float("nan"), 1.0), (float("inf"), 1.0)):
        played.seek(wanted)
        assert played.position == pytest.approx(got)


def test_a_loop_can_be_switched_on_and_off(clock: Clock) -> None:
    played = head(clock)
    played.loop = False
    clock.now += 9
    assert not played.playing
    assert not played.loop


def test_a_duration_that_is_learnt_at_the_end_holds_from_then_on(clock: Clock) -> None:
    played = Playhead(None, 0.1, clock=clock)
    clock.now += 1000
    assert (played.position, played.duration) == (pytest.approx(1000), float("inf"))
    played.seek(1.9)
    played.lasts(2.0)
    clock.now += 0.5
    assert (played.position, played.duration) == (pytest.approx(0.4), 2.0)
    with pytest.raises(ValueError, match="above 0"):
        played.lasts(0.0)


@pytest.mark.parametrize("duration", [0.0, -1.0, float("inf"), np.nan])
def test_what_has_no_length_cannot_be_played(duration: float, clock: Clock) -> None:
    with pytest.raises(ValueError, match="above 0"):
        Playhead(duration, 0.1, clock=clock)
