"""The loop, with everything but the capture thread: orders in, pictures and outputs out."""

import socket
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gemheads.app.desk.actions import Order
from gemheads.app.desk.command import played
from gemheads.app.desk.driving import Driving
from gemheads.app.desk.keys import keymap
from gemheads.app.desk.offscreen import DeskOffscreen
from gemheads.app.desk.outputs import Outputs
from gemheads.app.desk.painter import CURTAIN
from gemheads.app.desk.remote import Remote
from gemheads.app.desk.resting import NeutralTaking
from gemheads.app.desk.roster import Roster
from gemheads.app.desk.session import Session
from gemheads.app.desk.state import DeskState
from gemheads.app.desk.view import Toast
from gemheads.app.live import run_live
from gemheads.app.performing.ladder import Quality
from gemheads.app.performing.shots import Health
from gemheads.app.person.coach import coach
from gemheads.app.person.restface import RestSession
from gemheads.render.software import SoftwareEngine
from keepers import Keeper
from osc import message
from waiting import eventually, in_words

from ..scripted import avatar
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


def test_a_message_takes_the_place_of_the_last_on_its_topic(room: Room) -> None:
    for words, topic in (("one", ""), ("slow", "quality"), ("two", ""), ("slower", "quality")):
        room.session.tell(words, topic=topic)
    assert [toast.text for toast in room.session.view(time.perf_counter()).toasts] == ["one", "two", "slower"]


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


def test_the_next_but_one_is_asked_for_by_asking_twice(room: Room) -> None:
    begin(room)
    paths = room.session.stage.roster.paths
    room.session.obey(Order("next_avatar"))
    room.session.obey(Order("next_avatar"))
    assert room.session.stage.coming == paths[2 % len(paths)]


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


def test_sliders_reach_the_capture_and_the_source_is_what_was_asked_for(room: Room, tmp_path: Path) -> None:
    begin(room)
    for order in (Order("smoothing", 0.9), Order("gain_mouth", 1.5), Order("head_pose", 0.0), Order("relock")):
        room.session.obey(order)
    turn(room.session)
    calls = {name: arguments for name, *arguments in room.capture.calls}
    tuning = calls["tune"][0]
    assert (tuning.smoothing, tuning.gains["mouth"], tuning.head_pose) == (0.9, 1.5, False)
    assert "relock" in calls
    assert calls["use"][1] == "Performance"
    (tmp_path / "clip.mp4").touch()
    for order, name in (
        (Order("demo"), "The demo"),
        (Order("open", f'"{tmp_path / "clip.mp4"}"'), "clip.mp4"),
        (Order("open", (tmp_path / "clip.mp4").as_uri()), "clip.mp4"),
        (Order("open", str(tmp_path / "clip, mistyped.mp4")), "clip.mp4"),
        (Order("camera", "Nice Cam"), "Nice Cam"),
        (Order("no_source"), ""),
    ):
        room.session.obey(order)
        assert room.capture.calls[-1][0] in ("use", "rest")
        assert [call for call in room.capture.calls if call[0] == "use"][-1][2] == name
    room.session.obey(Order("open", "osc:99999999"))
    assert room.session.view(time.perf_counter()).toasts[-1].alarm


def test_a_camera_is_remembered_by_its_name_once_it_shows_a_picture(room: Room) -> None:
    begin(room)
    room.session.driving.camera = "Old Cam"
    room.session.obey(Order("camera", "nice"))
    turn(room.session)
    assert room.session.driving.camera == "Old Cam"  # nobody knows yet whether there is such a one
    room.capture.health = Health("tracking", frames=1, source="Nice Cam")
    turn(room.session)
    assert room.session.driving.camera == "Nice Cam"


def test_a_camera_that_runs_is_not_opened_again_and_one_that_is_gone_is(room: Room) -> None:
    begin(room)
    room.session.obey(Order("camera", "nice"))
    room.capture.health = Health("tracking", frames=1, source="Nice Cam")
    turn(room.session)

    def opened() -> list[str]:
        return [arguments[1] for name, *arguments in room.capture.calls if name == "use"][1:]

    room.session.obey(Order("play", 0.0))
    for word in ("", "nice", "Nice Cam"):
        room.session.obey(Order("camera", word))
        assert room.session.view(time.perf_counter()).toasts[-1].text == "Nice Cam runs already."
    assert not room.session.state.frozen
    assert opened() == ["nice"]
    room.session.obey(Order("camera", "Other Cam"))
    assert opened() == ["nice", "Other Cam"]
    room.capture.health = Health("stalled", frames=9, source="Other Cam")
    turn(room.session)
    room.session.obey(Order("camera", "Other Cam"))
    assert opened() == ["nice", "Other Cam", "Other Cam"]


def test_a_neutral_is_not_taken_where_there_is_no_picture(room: Room) -> None:
    begin(room)
    room.session.obey(Order("neutral"))
    assert not room.session.state.resting
    assert "choose your camera" in room.session.view(0.0).toasts[-1].text


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


def test_a_neutral_is_not_taken_of_two_sources(room: Room) -> None:
    begin(room)
    room.capture.health = Health("tracking", pictured=True)
    room.session.obey(Order("neutral"))
    turn(room.session)
    room.session.driving.neutral._session = RestSession("collecting", green_at=1.0)
    room.session.obey(Order("demo"))
    turn(room.session)
    assert room.session.driving.neutral._session == RestSession(coaching=coach(None, 0.0))


def test_an_avatar_that_no_face_drives_ends_the_taking_of_a_neutral_with_the_reason() -> None:
    """As it does when it comes on stage meanwhile."""
    taking = NeutralTaking()
    taking._session = RestSession("collecting")
    assert taking.advance(None, Health(), avatar(arkit=False), 1e6) is None
    assert not taking.on
    assert "has no regressor" in taking.told().result


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
