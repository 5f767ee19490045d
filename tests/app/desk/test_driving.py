"""What reaches the capture thread: sliders, sources, the neutral."""

import time
from pathlib import Path

from gemheads.app.desk.actions import Order
from gemheads.app.desk.resting import NeutralTaking
from gemheads.app.performing.shots import Health
from gemheads.app.person.coach import coach
from gemheads.app.person.restface import RestSession

from ..scripted import avatar
from .conftest import Room
from .rounds import begin, turn


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


def test_a_neutral_is_not_taken_where_there_is_no_picture(room: Room) -> None:
    begin(room)
    room.session.obey(Order("neutral"))
    assert not room.session.state.resting
    assert "choose your camera" in room.session.view(0.0).toasts[-1].text


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
