from pathlib import Path

import pytest
from gemheads.app.errors import InputError
from gemheads.app.library import DEFAULT, Entry, avatars, find_avatar


@pytest.fixture
def folders(tmp_path: Path) -> tuple[tuple[Path, bool], ...]:
    mine, shipped = tmp_path / "mine", tmp_path / "shipped"
    for folder, names in ((mine, ("zoe", "ada")), (shipped, ("ada", "bo"))):
        folder.mkdir()
        for name in names:
            (folder / f"{name}.gem").touch()
    (shipped / "notes.txt").touch()
    return (mine, False), (shipped, True)


def test_a_users_own_avatar_hides_the_shipped_one_of_its_name(folders: tuple[tuple[Path, bool], ...]) -> None:
    found = {entry.name: entry.shipped for entry in avatars(folders)}
    assert found == {"ada": False, "bo": True, "zoe": False}


def test_what_macos_puts_beside_an_avatar_is_none(tmp_path: Path) -> None:
    for name in ("ada.gem", "._ada.gem"):
        (tmp_path / name).touch()
    assert [entry.name for entry in avatars(((tmp_path, False),))] == ["ada"]


def test_folders_that_are_not_there_hold_no_avatars(tmp_path: Path) -> None:
    assert avatars(((tmp_path / "none", False),)) == []


def test_by_name_by_path_and_by_default(folders: tuple[tuple[Path, bool], ...], tmp_path: Path) -> None:
    entries = avatars(folders)
    assert find_avatar("zoe", entries) == tmp_path / "mine" / "zoe.gem"
    assert find_avatar(str(tmp_path / "shipped" / "bo.gem"), entries) == tmp_path / "shipped" / "bo.gem"
    assert find_avatar(None, entries) == tmp_path / "shipped" / "bo.gem"


def test_the_default_is_the_favourite_where_it_ships(tmp_path: Path) -> None:
    entries = [Entry(name, tmp_path / name, shipped=True) for name in ("ada", DEFAULT, "zoe")]
    assert find_avatar(None, entries) == tmp_path / DEFAULT


def test_an_unknown_avatar_is_told_with_those_there_are(folders: tuple[tuple[Path, bool], ...]) -> None:
    with pytest.raises(InputError, match=r"nobody: neither .*there are: ada, bo, zoe"):
        find_avatar("nobody", avatars(folders))


def test_no_avatar_at_all_is_told_with_its_cure() -> None:
    with pytest.raises(InputError, match="make avatars"):
        find_avatar(None, [])


def test_a_library_of_only_own_avatars_has_a_default(tmp_path: Path) -> None:
    own = Entry("own", tmp_path / "own.gem", shipped=False)
    assert find_avatar(None, [own]) == own.path


def test_the_default_is_the_users_own_where_it_has_the_favourites_name(tmp_path: Path) -> None:
    entries = [Entry("ada", tmp_path / "ada.gem", True), Entry(DEFAULT, tmp_path / "mine.gem", False)]
    assert find_avatar(None, entries) == tmp_path / "mine.gem"
