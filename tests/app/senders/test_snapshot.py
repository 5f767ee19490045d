import errno
import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import cv2
import numpy as np
import pytest
from gemheads.app.errors import OutputError
from gemheads.app.senders.outlet import Marks, Shown
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


def test_pictures_saved_at_once_are_all_saved(tmp_path: Path) -> None:
    waiting = Barrier(4)

    def save(shade: int) -> None:
        waiting.wait()
        save_picture(np.full((64, 64, 3), shade, np.uint8), tmp_path, signed=lambda data: time.sleep(0.01) or data)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(save, (10, 20, 30, 40)))
    pictures = [cv2.imread(str(path)) for path in sorted(tmp_path.iterdir())]
    assert sorted(int(picture[0, 0, 0]) for picture in pictures if picture is not None) == [10, 20, 30, 40]


def test_what_is_transparent_lends_no_colour_to_what_is_drawn_larger(tmp_path: Path) -> None:
    """Straight alpha cannot be resized as it is: rims would be dark."""
    picture = np.zeros((8, 8, 4), np.uint8)
    picture[2:6, 2:6] = 255
    for size in ((16, 16), (6, 6)):
        Snapshot(tmp_path, size).send(Shown(picture, 0.0, marks=Marks(no_badge="a test")))
        saved = cv2.imread(str(max(tmp_path.iterdir())), cv2.IMREAD_UNCHANGED)
        assert saved is not None
        assert len(np.unique(saved[..., 3])) > 2
        assert (saved[saved[..., 3] > 0] >= 254)[:, :3].all()


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
