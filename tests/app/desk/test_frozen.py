"""What stands still when a picture is frozen, and which button of a source does it."""

import time

import av
import numpy as np
import pytest
from gemheads.app.desk import session as session_module
from gemheads.app.desk.actions import Order
from keepers import Keeper

from .conftest import Room
from .rounds import begin, turn, until


def test_space_freezes_where_nothing_can_be_paused(room: Room) -> None:
    begin(room)
    room.capture.post(1.0)
    turn(room.session)
    room.session.obey(Order("play"))
    room.capture.post(3.0)
    assert turn(room.session) is not None  # the state changed; the pose did not
    assert room.session.stage.shot is not None
    assert room.session.stage.shot.serial == 1
    room.session.obey(Order("play"))
    room.capture.post(3.0)
    turn(room.session)
    assert room.session.stage.shot.serial == 3


class Buttons:
    """A transport that writes down what is pressed."""

    playing, loop, position, duration = True, True, 3.0, 10.0

    def __init__(self) -> None:
        self.pressed: list[tuple[str, float]] = []

    def play(self) -> None:
        self.pressed.append(("play", 1))

    def pause(self) -> None:
        self.pressed.append(("pause", 1))

    def step(self, frames: int) -> None:
        self.pressed.append(("step", frames))

    def seek(self, seconds: float) -> None:
        self.pressed.append(("seek", seconds))


def test_a_source_with_buttons_gets_them_pressed(room: Room) -> None:
    begin(room)
    room.capture.transport = buttons = Buttons()
    for order in (
        Order("play"),
        Order("play", 1.0),
        Order("step", -1.0, relative=True),
        Order("seek", 5.0, relative=True),
        Order("seek", 99.0),
    ):
        room.session.obey(order)
    assert buttons.pressed == [("pause", 1), ("play", 1), ("step", -1), ("seek", 8.0), ("seek", 10.0)]
    assert not room.session.state.frozen


def test_a_source_that_is_opened_later_loops_as_the_switch_says(room: Room) -> None:
    begin(room)
    for looping in (False, True):
        room.session.obey(Order("loop"))
        room.capture.transport = buttons = Buttons()
        buttons.loop = not looping
        turn(room.session)
        assert buttons.loop is room.session.state.loop is looping


@pytest.mark.parametrize(
    "order",
    [Order("open", __file__), Order("camera"), Order("demo"), Order("no_source")],
    ids=lambda order: order.name,
)
def test_another_source_moves_though_the_last_one_was_frozen(order: Order, room: Room) -> None:
    begin(room)
    room.session.obey(Order("play", 0.0))
    assert room.session.state.frozen
    room.session.obey(order)
    assert not room.session.state.frozen


@pytest.mark.parametrize("word", ["osc:99999999", "other.gem"])
def test_what_changes_no_source_leaves_it_frozen(word: str, room: Room) -> None:
    begin(room)
    room.session.obey(Order("play", 0.0))
    room.session.obey(Order("open", word))
    assert room.session.state.frozen


def test_what_is_frozen_while_it_is_opened_is_paused_once_it_can_be(room: Room) -> None:
    begin(room)
    room.session.obey(Order("play"))
    room.capture.transport = buttons = Buttons()
    turn(room.session)
    assert buttons.pressed == [("pause", 1)]
    assert not room.session.state.frozen


def test_a_frozen_picture_goes_on_to_outputs_and_can_be_saved(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session_module, "REPEAT_SECS", 0.01)
    begin(room)
    room.session.obey(Order("play"))
    room.capture.post(1.0)
    still = turn(room.session)
    assert turn(room.session) is None  # nobody listens: nothing is drawn
    room.session.obey(Order("picture"))
    until(room.session, lambda: bool(list(room.folder.glob("*.png"))))
    spy = Keeper()
    room.session.outputs.fan.start("spy", lambda: spy)
    until(room.session, lambda: len(spy.kept) > 2)
    assert all(np.array_equal(shown.picture, still) for shown in spy.kept)


def test_a_clean_window_is_drawn_again_though_the_picture_stands_still(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else it would notice neither its close button nor its size."""
    monkeypatch.setattr(session_module, "REPEAT_SECS", 0.01)
    begin(room)
    room.session.obey(Order("play"))
    room.session.obey(Order("clean_window"))
    turn(room.session)
    for _ in range(3):
        time.sleep(0.02)
        assert turn(room.session) is not None


def test_a_recording_lasts_until_it_is_stopped_though_the_picture_was_frozen(room: Room) -> None:
    """It begins with a picture that is shown in one round, and ends in another: a clock before and after each tells the
    least and the most that it may last, however busy the machine is."""

    def switched() -> tuple[float, float]:
        before = time.perf_counter()
        room.session.obey(Order("record"))
        turn(room.session)
        return before, time.perf_counter()

    begin(room)
    room.session.obey(Order("play"))
    turn(room.session)
    begun = switched()
    time.sleep(0.2)
    ended = switched()
    assert room.session.outputs.fan.close(20)
    with av.open(str(next(room.folder.glob("*.mp4")))) as container:
        times = [float(frame.pts * frame.time_base) for frame in container.decode(video=0)]
    tick = 0.001
    assert ended[0] - begun[1] - tick <= times[-1] <= ended[1] - begun[0] + tick
