"""Where results go: found out early, and what took hours is not lost for want of room."""

import errno
import os
import re
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.errors import OutputError, UsageError
from gemheads.app.files.places import check_places, save_learned
from safetensors.numpy import save_file


class Disk:
    """A disk that is full in some of its folders."""

    def __init__(self, *full: Path) -> None:
        self._full = full

    def save(self, path: Path) -> None:
        if any(folder in path.parents for folder in self._full):
            raise OSError(errno.ENOSPC, "No space left on device")
        path.write_bytes(b"learned")


def test_folders_are_made_and_nothing_is_left_in_them(tmp_path: Path) -> None:
    check_places(tmp_path / "new" / "er" / "a.gem", None, tmp_path / "new" / "b.png")
    assert [path.name for path in tmp_path.rglob("*")] == ["new", "er"]


def test_a_folder_that_cannot_be_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=f"{tmp_path / 'file'}: cannot be written .*; choose another folder"):
        check_places(tmp_path / "a", tmp_path / "file" / "b")


def test_a_name_that_no_disk_takes_and_what_is_no_file_are_told(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="File name too long"):
        check_places(tmp_path / f"{300 * 'x'}.gem")
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        with pytest.raises(OutputError, match="is a pipe or a device; name a file"):
            check_places(tmp_path / "pipe")


def test_nothing_is_written_over_what_is_read_or_over_another_result(tmp_path: Path) -> None:
    capture, avatar = tmp_path / "capture", tmp_path / "a.gem"
    capture.mkdir()
    for file in (avatar, capture / "template.npz"):
        file.touch()
    save_file({"pts": np.zeros(1)}, capture / "before.track")
    for outs, said in (
        ([avatar], "is read"),
        ([tmp_path / "b.gem", tmp_path / "capture" / ".." / "b.gem"], "two results would have this name"),
        ([capture / "template.npz"], "a part of .*capture"),
    ):
        with pytest.raises(UsageError, match=said):
            check_places(*outs, read=[avatar, None, capture])
    check_places(capture / "before.track", capture / "new.png", tmp_path / "c.gem", read=[avatar, capture])


def test_what_is_learned_is_saved_where_it_should_be(tmp_path: Path) -> None:
    save_learned(Disk().save, tmp_path / "a.gem")
    assert (tmp_path / "a.gem").read_bytes() == b"learned"


def test_where_the_disk_has_become_full_it_is_kept_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "spare").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "spare"))
    with pytest.raises(OutputError, match="No space left") as caught:
        save_learned(Disk(tmp_path / "full").save, tmp_path / "full" / "a.gem")
    (kept,) = re.findall(r"kept as (\S+):", str(caught.value))
    assert Path(kept).read_bytes() == b"learned"
    with pytest.raises(OutputError, match="check the folder and the space, and run again"):
        save_learned(Disk(tmp_path).save, tmp_path / "full" / "a.gem")
