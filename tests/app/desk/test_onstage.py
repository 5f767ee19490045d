"""Which avatar is on stage: the first, another one, and those that cannot be."""

import time
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.desk.actions import Order
from gemheads.app.desk.command import played
from gemheads.app.desk.driving import Driving
from gemheads.app.desk.keys import keymap
from gemheads.app.desk.outputs import Outputs
from gemheads.app.desk.roster import Roster
from gemheads.app.desk.session import Session
from gemheads.app.desk.state import DeskState
from gemheads.render.software import SoftwareEngine
from waiting import eventually

from .conftest import FakeCapture, Room
from .rounds import begin, turn, until


def test_the_first_avatar_comes_at_rest_and_follows_the_newest_shot(room: Room) -> None:
    rest = begin(room)
    assert rest.shape == (96, 96, 3)
    assert turn(room.session) is None  # nothing new: nothing is drawn
    room.capture.post(0.5)
    room.capture.post(3.0)
    moved = turn(room.session)
    assert moved is not None
    assert np.abs(moved.astype(int) - rest).max() > 20
    assert room.session.stage.shot is not None
    assert room.session.stage.shot.serial == 2
    assert turn(room.session) is None


def test_switching_shows_the_new_avatar_within_two_frames_and_the_loop_goes_on(room: Room) -> None:
    begin(room)
    room.capture.post(1.0)
    before = turn(room.session)
    room.session.obey(Order("avatar", 2.0))
    frames, loaded_at = 0, None
    while room.session.stage.roster.current != 1:
        room.capture.post(1.0)
        was_loading = room.session.stage.loading
        assert turn(room.session) is not None  # every round has its picture
        frames += 1
        if loaded_at is None and was_loading and not room.session.stage.loading:
            loaded_at = frames
        assert frames < 5000
    assert loaded_at is not None
    assert frames - loaded_at < 2
    room.capture.post(1.0)
    after = turn(room.session)
    assert after is not None
    assert before is not None
    assert np.abs(after.astype(int) - before).mean() > 1
    assert room.session.view(0.0).avatar.name == "tiny"
    assert room.session.view(0.0).on_stage == 1


def test_an_avatar_that_nothing_drives_yet_comes_on_stage_all_the_same(room: Room) -> None:
    begin(room)
    room.capture.answers_cast = False
    room.session.obey(Order("next_avatar"))
    until(room.session, lambda: room.session.stage.roster.current == 1)


def test_a_broken_file_is_refused_with_its_reason_and_the_old_avatar_stays(
    room: Room, avatars: tuple[Path, ...]
) -> None:
    begin(room)
    for order in (Order("avatar", 3.0), Order("open", str(avatars[0].parent / "missing.gem"))):
        room.session.obey(order)
        room.capture.post(2.0)
        until(room.session, lambda: not room.session.stage.loading)
        toasts = room.session.view(time.perf_counter()).toasts
        assert toasts[-1].alarm
        assert ".gem" in toasts[-1].text
        assert room.session.stage.roster.current == 0
        room.capture.post(1.0)
        assert turn(room.session) is not None


@pytest.mark.parametrize("spare", ["anna.gem", "broken.gem"])
def test_where_the_first_avatar_is_refused_the_spare_one_comes_and_why_is_told(
    avatars: tuple[Path, ...], spare: str
) -> None:
    folder = avatars[0].parent
    session = Session(
        *(
            DeskState(),
            Roster((folder / "broken.gem",)),
            keymap(),
            SoftwareEngine,
            Outputs((96, 96), 30, Path),
            (96, 96),
        ),
        driving=Driving(lambda words, alarm: session.tell(words, alarm), FakeCapture),
        spare=folder / spare,
    )
    assert played(session, "before.gem") == "before.gem"
    eventually(lambda: session.settle(time.perf_counter()) or session.view(time.perf_counter()).toasts)
    assert "broken.gem" in session.view(time.perf_counter()).toasts[0].text
    if spare == "anna.gem":
        until(session, lambda: session.stage.avatar is not None)
        assert played(session, "before.gem") == str(folder / spare)
    else:
        eventually(lambda: session.settle(time.perf_counter()) or not session.stage.loading)
        assert played(session, "before.gem") == "before.gem"
    session.close()


def test_the_next_but_one_is_asked_for_by_asking_twice(room: Room) -> None:
    begin(room)
    paths = room.session.stage.roster.paths
    room.session.obey(Order("next_avatar"))
    room.session.obey(Order("next_avatar"))
    assert room.session.stage.coming == paths[2 % len(paths)]


@pytest.mark.parametrize("bound", [False, True])
def test_the_next_picture_is_drawn_while_one_is_shown_only_beside_the_window(
    room: Room, bound: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin(room)
    monkeypatch.setattr(SoftwareEngine, "bound", bound)
    room.capture.post(1.0)
    room.session.draw(time.perf_counter(), beside=True)
    assert room.session.stage.free is bound
    assert bool(room.capture.waiting) is bound, "a shot that is not drawn yet may still be replaced by a newer one"
