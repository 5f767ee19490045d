"""The loop, with everything but the capture thread: orders in, pictures out."""

import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gemheads.app.desk.actions import Order
from gemheads.app.desk.offscreen import DeskOffscreen
from gemheads.app.desk.remote import Remote
from gemheads.app.desk.view import Toast
from gemheads.app.live import run_live
from gemheads.app.performing.ladder import Quality
from osc import message
from waiting import eventually, in_words

from .conftest import Room
from .rounds import begin, turn, until


def test_a_message_takes_the_place_of_the_last_on_its_topic(room: Room) -> None:
    for words, topic in (("one", ""), ("slow", "quality"), ("two", ""), ("slower", "quality")):
        room.session.tell(words, topic=topic)
    assert [toast.text for toast in room.session.view(time.perf_counter()).toasts] == ["one", "two", "slower"]


def test_components_and_modalities_change_the_next_picture(room: Room) -> None:
    begin(room)
    room.capture.post(3.0)
    whole = turn(room.session)
    assert whole is not None
    room.session.obey(Order("components", 1.0))
    fewer = turn(room.session)
    assert fewer is not None
    assert (fewer != whole).any()
    room.session.obey(Order("components", 99.0))
    room.session.obey(Order("position"))
    still = turn(room.session)
    assert still is not None
    assert (still != whole).any()
    room.session.obey(Order("position"))
    again = turn(room.session)
    assert again is not None
    np.testing.assert_array_equal(again, whole)


def test_what_is_explored_is_seen_however_few_components_are_drawn(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    begin(room)
    session = room.session
    monkeypatch.setattr(session.gauges, "quality", lambda components: Quality(min(components, 2)))
    for order in (Order("components", 1.0), Order("explored_component", 4.0), Order("explore")):
        session.obey(order)
    still = turn(session)
    session.obey(Order("sigma", 3.0))
    moved = turn(session)
    assert still is not None
    assert moved is not None
    assert (moved != still).any()


@pytest.mark.parametrize(
    "order",
    [Order("avatar", float("nan")), Order("step", float("inf")), Order("avatar", -1e12), Order("seek", float("-inf"))],
)
def test_numbers_beyond_sense_ask_for_nothing(room: Room, order: Order) -> None:
    begin(room)
    before = room.session.state
    room.session.obey(order)
    assert room.session.state == before
    assert room.session.stage.loading == ""


@pytest.mark.parametrize("words", ["~nobody-of-this-name/x.gem", "osc:" + 300 * "x", "a\0b.gem"])
def test_a_path_that_can_be_none_is_told(room: Room, words: str) -> None:
    begin(room)
    room.session.obey(Order("open", words))

    def toasts() -> tuple[Toast, ...]:
        turn(room.session)
        return room.session.view(time.perf_counter()).toasts

    assert eventually(toasts)[-1].alarm


def test_the_comparison_names_what_is_lost(room: Room) -> None:
    begin(room)
    room.capture.post(3.0)
    room.session.obey(Order("compare", 1.0))
    turn(room.session)
    assert room.session.view(0.0).error_db == pytest.approx(100)
    room.session.obey(Order("components", 1.0))
    turn(room.session)
    lost = room.session.view(0.0).error_db
    assert lost is not None
    assert lost < 60


def test_what_stands_still_and_what_is_saved_is_drawn_whole_however_slow_the_machine(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin(room)
    session = room.session
    monkeypatch.setattr(session.gauges, "quality", lambda components: Quality(1, 0.5))

    def drawn() -> int:
        room.capture.post(float(room.capture.serial % 3))
        return until(session, lambda: True).shape[0]

    assert drawn() == 48
    session.obey(Order("picture"))
    assert drawn() == 96
    assert drawn() == 48
    assert session.view(0.0).readings.lowered
    session.obey(Order("play", 0.0))
    assert until(session, lambda: True).shape[0] == 96  # it stands still
    assert not session.view(0.0).readings.lowered, "what is drawn whole is said to be lowered"
    session.obey(Order("play", 1.0))
    assert drawn() == 48
    room.capture.transport = SimpleNamespace(playing=False, loop=True)
    assert drawn() == 96  # a video that is paused
    assert not session.view(0.0).readings.lowered


@pytest.mark.enable_socket
def test_the_window_runs_by_keys_drops_and_osc_and_ends_in_under_a_second(
    room: Room, desk: DeskOffscreen, avatars: tuple[Path, ...]
) -> None:
    session = room.session
    session.remote = remote = Remote("127.0.0.1", 0)
    failures: list[BaseException] = []

    def person() -> None:
        try:
            wait(lambda: session.stage.avatar is not None)
            desk.press("B")
            wait(lambda: session.state.compare)
            desk.drop(str(avatars[1]))
            wait(lambda: session.stage.roster.current == 1)
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
                for address, value in (("smoothing", 0.25), ("background", "green")):
                    other.sendto(message(f"/gemheads/{address}", value), ("127.0.0.1", remote.port))
            wait(lambda: session.state.smoothing == 0.25 and session.state.background == "green")
            desk.press("W")
            wait(lambda: desk.clean_picture is not None and desk.shown > 5)
        except BaseException as error:
            failures.append(error)
        ended.append(time.perf_counter())
        desk.press("Ctrl+Q")

    def wait(done: Callable[[], bool]) -> None:
        def so() -> bool:
            room.captures and room.captures[0].post(2.0)
            return done()

        eventually(so, what=in_words(done))

    ended: list[float] = []
    hands = threading.Thread(target=person)
    hands.start()
    run_live(desk, session)
    session.close()
    assert time.perf_counter() - ended[0] < 1.0
    hands.join()
    assert not failures, failures
