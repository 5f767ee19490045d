"""Avatars are opened beside the window, each of them once."""

from pathlib import Path

import pytest
from gemheads.app.desk import loader
from gemheads.app.desk.loader import Loader, Refused, open_for_stage
from gemheads.app.performing.casting import Avatar
from waiting import eventually


def answer(loading: Loader, path: Path) -> Avatar | Refused | None:
    """What comes of asking for an avatar."""
    loading.open(path)
    found: list[Avatar | Refused] = []
    eventually(lambda: found or found.extend(filter(None, [loading.newest()])), what="an avatar, or why there is none")
    return found[0]


def test_an_avatar_that_is_open_already_is_not_read_again_but_for_its_next_turn(
    avatars: tuple[Path, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    anna, berta, _ = avatars
    before, read = open_for_stage(anna), []
    monkeypatch.setattr(loader, "open_for_stage", lambda path: read.append(path) or open_for_stage(path))
    loading = Loader(opened=[before])
    spelt = anna.parent / "." / ".." / anna.parent.name / anna.name
    first = answer(loading, spelt)
    assert isinstance(first, Avatar)
    assert (first.gem is before.gem, first.path, read) == (True, spelt, [])
    for path in (berta, anna):  # a file may have been written anew meanwhile
        assert isinstance(answer(loading, path), Avatar)
    assert read == [berta, anna]
    loading.close()
