"""What gets its final name is on the disk before: after a power cut too there is the old file or the new one."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.credentials.localkey import local_key
from gemheads.app.senders.outlet import Shown
from gemheads.app.senders.recording import Recording
from gemheads.app.senders.snapshot import save_picture
from gemheads.models.wholefile import write_whole

from .writers import WRITTEN

PICTURE = np.full((48, 64, 3), 90, np.uint8)


def record(path: Path) -> None:
    recording = Recording(path, (64, 48), 30)
    recording.send(Shown(PICTURE, 0.0))
    recording.close()


OTHERS: dict[str, Callable[[Path], Any]] = {
    "a recording": lambda folder: record(folder / "a.mp4"),
    "a saved picture": lambda folder: save_picture(PICTURE, folder),
}


@pytest.fixture
def named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> dict[str, bool]:
    """Name -> whether the file that got it was on the disk before; filled while the test runs."""
    settled: set[int] = set()
    given: dict[str, bool] = {}
    sync = os.fsync

    def synced(descriptor: int) -> None:
        sync(descriptor)
        settled.add(os.fstat(descriptor).st_ino)

    def watched(give: Callable[..., None]) -> Callable[..., None]:
        def renamed(source: Any, target: Any, *more: Any, **settings: Any) -> None:
            if tmp_path in Path(target).parents and Path(source).is_file():
                given[Path(target).name] = os.stat(source).st_ino in settled
            give(source, target, *more, **settings)

        return renamed

    monkeypatch.setattr(os, "fsync", synced)
    for name in ("replace", "rename", "link"):
        monkeypatch.setattr(os, name, watched(getattr(os, name)))
    return given


@pytest.mark.parametrize("written", WRITTEN, ids=lambda written: written.name)
def test_results_are(written: Any, tmp_path: Path, named: dict[str, bool]) -> None:
    written.write(tmp_path / written.name, 0)
    assert named
    assert all(named.values()), named


@pytest.mark.parametrize("what", OTHERS)
def test_what_live_saves_is(what: str, tmp_path: Path, named: dict[str, bool]) -> None:
    OTHERS[what](tmp_path)
    assert named
    assert all(named.values()), named


def test_the_signing_key_is(tmp_path: Path, named: dict[str, bool]) -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    local_key(tmp_path / "key.pem")
    assert named == {"key.pem": True}


def test_a_file_that_is_not_would_be_noticed(
    tmp_path: Path, named: dict[str, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", lambda descriptor: None)
    write_whole(tmp_path / "a", [b"a"])
    assert named == {"a": False}
