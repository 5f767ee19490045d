"""Files that appear whole or not at all, whatever they are called."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from gemheads.models.wholefile import marked, partials_of, write_whole

LONG = "n" * 251 + ".gem"
"""As long as most disks take."""


def test_a_name_as_long_as_the_disk_takes_is_written(tmp_path: Path) -> None:
    for name in (LONG, "ø" * 125 + ".gem"):
        write_whole(tmp_path / name, [b"whole"])
        assert (tmp_path / name).read_bytes() == b"whole"
        assert partials_of(tmp_path / name) == []
    assert len(list(tmp_path.iterdir())) == 2


def test_an_unfinished_name_keeps_its_suffix_and_fits_on_the_disk(tmp_path: Path) -> None:
    assert marked(tmp_path / "a.b.mp4", "partial") == tmp_path / "a.b.partial.mp4"
    names = [marked(tmp_path / f"{letter * length}.mp4", "partial") for letter, length in (("n", 251), ("ø", 125))]
    for name in names:
        assert name.name.endswith(".partial.mp4")
        (tmp_path / f".{name.name}").touch()
    assert len(set(names)) == 2


@pytest.mark.parametrize("name", ["a.gem", LONG])
def test_what_is_not_whole_yet_can_be_found(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    found: list[int] = []

    def parts() -> Iterator[bytes]:
        yield b"half"
        found.append(len(partials_of(path)))
        yield b"and half"

    write_whole(path, parts())
    assert found == [1]
    assert path.read_bytes() == b"halfand half"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows links only for administrators")
def test_a_link_stays_one_and_what_it_stands_for_is_written(tmp_path: Path) -> None:
    (tmp_path / "store").mkdir()
    for there in (True, False):
        real, link = tmp_path / "store" / f"{there}.gem", tmp_path / f"{there}.gem"
        if there:
            real.write_bytes(b"before")
        link.symlink_to(real)
        write_whole(link, [b"now"])
        assert link.is_symlink()
        assert real.read_bytes() == b"now"
