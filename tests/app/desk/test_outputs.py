"""What recordings, saved pictures and other programs get of the window."""

import time
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.desk.actions import Order
from gemheads.app.desk.painter import CURTAIN
from gemheads.app.performing.ladder import Quality
from keepers import Keeper
from waiting import eventually

from .conftest import Room
from .rounds import begin, turn, until


def test_outputs_get_the_avatar_without_comparison_or_panels_and_nothing_behind_the_curtain(room: Room) -> None:
    begin(room)
    spy = Keeper()
    room.session.outputs.fan.start("spy", lambda: spy)
    room.capture.post(3.0)
    plain = turn(room.session)
    for name in ("compare", "error_map"):
        room.session.obey(Order(name, 1.0))
    room.session.obey(Order("components", 1.0))
    room.session.obey(Order("components", 99.0))
    with_split = turn(room.session)
    assert plain is not None
    assert with_split is not None
    np.testing.assert_array_equal(plain, with_split)
    room.session.obey(Order("curtain"))
    hidden = turn(room.session)
    assert hidden is not None
    assert (hidden == CURTAIN).all()
    eventually(lambda: spy.kept and spy.kept[-1].pose is None)
    assert (spy.kept[-1].picture == CURTAIN).all()
    assert spy.kept[-1].avatar == ""


def test_outputs_know_the_ground_before_a_transparent_one(room: Room) -> None:
    begin(room)
    spy = Keeper()
    room.session.outputs.fan.start("spy", lambda: spy)
    for background in ("white", "transparent"):
        room.session.obey(Order("background", background))
        shown = turn(room.session)
    assert shown is not None
    assert shown.shape[2] == 4
    eventually(lambda: spy.kept and spy.kept[-1].picture.shape[2] == 4)
    assert spy.kept[-1].marks.ground == (255, 255, 255)


def test_a_picture_that_was_begun_before_the_curtain_fell_is_not_shown(room: Room) -> None:
    begin(room)
    room.capture.post(3.0)
    now = time.perf_counter()
    room.session.settle(now)
    room.session.draw(now)
    room.session.obey(Order("curtain", 1.0))
    drawn = eventually(room.session.drawn)
    assert drawn is not None
    assert (drawn.picture == CURTAIN).all()
    assert (drawn.preview == CURTAIN).all()
    assert drawn.pose is None


def test_a_recording_and_a_picture_are_written_and_a_failed_output_switches_itself_off(room: Room) -> None:
    begin(room)
    room.session.obey(Order("picture"))
    room.session.obey(Order("record"))

    def written() -> bool:
        room.capture.post(float(room.capture.serial % 3))
        return len(list(room.folder.glob("*.png"))) == 1 and any(
            "Recording" in line.name for line in room.session.view(0.0).outputs
        )

    until(room.session, written)
    room.session.obey(Order("record"))
    until(room.session, lambda: bool(list(room.folder.glob("*.mp4"))) or not room.session.state.record)
    assert not room.session.state.record

    def refuse() -> Path:
        raise PermissionError("this disk is full")

    (room.folder / "file").touch()
    room.session.outputs._folder = lambda: room.folder / "file" / "videos"
    room.session.obey(Order("record"))
    room.capture.post(2.0)
    until(room.session, lambda: not room.session.state.record)
    said = [toast.text for toast in room.session.view(time.perf_counter()).toasts if toast.alarm]
    assert f"see that {room.folder / 'file'} is a folder" in said[-1]
    assert "Error" not in said[-1]
    room.session.outputs._folder = refuse
    room.session.obey(Order("record"))
    room.capture.post(1.0)  # the state is as it was by the time a picture is drawn: only a shot is news
    until(room.session, lambda: not room.session.state.record)
    view = room.session.view(0.0)
    assert any(line.failed for line in view.outputs)
    said = [toast.text for toast in view.toasts]
    assert [words for words in said if words.startswith("Picture: saved ")]  # wherever the panel of outputs is
    assert [toast for toast in view.toasts if toast.alarm and "this disk is full" in toast.text]
    turn(room.session)
    assert [toast.text for toast in room.session.view(0.0).toasts] == said  # once


def test_what_is_saved_is_never_the_smaller_picture_that_was_under_way(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin(room)
    session, saved = room.session, []
    monkeypatch.setattr(session.gauges, "quality", lambda components: Quality(1, 0.5))
    monkeypatch.setattr(session.outputs, "picture", lambda: saved.append(None))
    room.capture.post(1.0)
    session.settle(0.0)
    session.draw(0.0)
    session.obey(Order("picture"))
    until(session, lambda: saved)
    assert until(session, lambda: True).shape[0] == 48
    assert len(saved) == 1
