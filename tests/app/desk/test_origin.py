"""Whose face is on stage: said when it comes, and handed to the outputs."""

import time
from dataclasses import replace
from pathlib import Path

from gemheads.app.desk.outputs import Outputs
from gemheads.app.desk.state import DeskState
from gemheads.app.performing.casting import open_avatar
from gemheads.models.gemfile import save_gem
from gems import ball
from waiting import eventually

from .conftest import Room


def settled(room: Room) -> str:
    """What is said once an avatar has been opened."""

    def come() -> bool:
        room.session.settle(time.perf_counter())
        return bool(room.captures)

    eventually(come, what="an avatar")
    return " ".join(toast.text for toast in room.session.view(time.perf_counter()).toasts)


def test_an_avatar_without_consent_says_so_when_it_comes(room: Room, tmp_path: Path) -> None:
    assert "consent" not in settled(room)  # the first one has it
    save_gem(replace(ball(3), name="somebody", about={}), tmp_path / "somebody.gem")
    assert room.session.driving.cast(open_avatar(tmp_path / "somebody.gem"))
    assert "somebody: licence not stated; no consent recorded" in settled(room)


def test_outputs_know_who_comes_on_stage(room: Room) -> None:
    settled(room)
    (origin,) = room.session.outputs.fan.marks.origins.values()
    assert (origin.name, origin.consent, origin.sha256) == ("tiny", "synthetic", room.capture.avatar.sha256)


def test_the_badge_is_what_the_state_says(tmp_path: Path) -> None:
    outputs = Outputs((32, 32), 30, lambda: tmp_path)
    outputs.settle(DeskState(no_badge="a test of this", camera_badge=True))
    assert (outputs.fan.marks.no_badge, outputs.fan.marks.camera_badge) == ("a test of this", True)
    outputs.settle(DeskState())
    assert (outputs.fan.marks.no_badge, outputs.fan.marks.camera_badge) == ("", False)
