import errno
import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.errors import OutputError
from gemheads.app.senders.outlet import Shown
from gemheads.app.senders.snapshot import Snapshot, save_picture

PICTURE = np.arange(5 * 4 * 4, dtype=np.uint8).reshape(5, 4, 4)


def test_alpha_and_colours_are_kept_exactly(tmp_path: Path) -> None:
    path = save_picture(PICTURE, tmp_path)
    read = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert read is not None
    assert (cv2.cvtColor(read, cv2.COLOR_BGRA2RGBA) == PICTURE).all()
    assert os.listdir(tmp_path) == ["gemheads-0001.png"]


def test_numbers_go_on_and_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "gemheads-0041.png").write_bytes(b"precious")
    (tmp_path / "gemheads-final.png").write_bytes(b"mine")
    assert save_picture(PICTURE[..., :3], tmp_path).name == "gemheads-0042.png"
    assert save_picture(PICTURE[..., :3], tmp_path).name == "gemheads-0043.png"
    assert (tmp_path / "gemheads-0041.png").read_bytes() == b"precious"


def test_a_file_system_without_links_will_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", refuse)
    assert [save_picture(PICTURE, tmp_path).name for _ in range(2)] == ["gemheads-0001.png", "gemheads-0002.png"]
    assert len(os.listdir(tmp_path)) == 2


def test_a_picture_that_cannot_be_saved_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be saved"):
        save_picture(PICTURE, tmp_path / "gone")
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be made"):
        Snapshot(tmp_path / "file", (8, 8))
    assert os.listdir(tmp_path) == ["file"]


def test_the_person_reads_where_it_went(tmp_path: Path) -> None:
    outlet = Snapshot(tmp_path / "new" / "folder", PICTURE.shape[1::-1])
    outlet.send(Shown(PICTURE, 0.0))
    assert outlet.status.startswith(f"saved {tmp_path / 'new' / 'folder' / 'gemheads-0001.png'}")
