import os
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from gemheads.app.desk.actions import Order
from gemheads.app.desk.keys import keymap
from gemheads.app.desk.settings import (
    MAX_BYTES,
    REMEMBERED,
    Settings,
    load_settings,
    recalled,
    remembered,
    save_settings,
)
from gemheads.app.desk.state import DeskState, update


def test_what_is_remembered_comes_back(tmp_path: Path) -> None:
    state = DeskState()
    for name, value in (("mirror", 0.0), ("smoothing", 0.8), ("background", "green"), ("ui_scale", 1.5)):
        state = update(state, Order(name, value))
    file = tmp_path / "new" / "live.toml"
    settings = remembered(
        state, Settings(avatar='a "b"\\c.gem', camera="Caméra", keys={"record": ("F9",)}, window=(640, 480))
    )
    assert save_settings(settings, file) == ""
    read, complaint = load_settings(file)
    assert complaint == ""
    assert read == settings
    assert recalled(DeskState(), read) == state


def test_what_a_person_wrote_while_the_window_was_open_stays(tmp_path: Path) -> None:
    file = tmp_path / "live.toml"
    settings = Settings({"mirror": True}, "a.gem", "Cam", (640, 480), {"record": ("F9",)})
    assert save_settings(settings, file) == ""
    theirs = (
        "since = 2026-11-26\n[desk]\nmirror = true\nfuture = 1\n[keys]\nrecord = ['F8']\n[mine]\na = {b = [1, 'c']}\n"
    )
    file.write_text(theirs)
    assert save_settings(replace(settings, wishes={"mirror": False}), file) == ""
    read, mine = load_settings(file)[0], tomllib.loads(file.read_text())
    assert read == replace(settings, wishes={"mirror": False}, keys={"record": ("F8",)})
    assert (str(mine["since"]), mine["desk"]["future"], mine["mine"]) == ("2026-11-26", 1, {"a": {"b": [1, "c"]}})
    file.write_text("[keys\n")
    assert "kept as" in save_settings(settings, file)
    assert load_settings(file) == (settings, "")


def test_names_that_are_hard_to_write_lose_nothing_else(tmp_path: Path) -> None:
    """TOML is UTF-8 and knows no halves of characters; what a disk or a camera calls itself may be any bytes."""
    file = tmp_path / "live.toml"
    smile = Settings(avatar="\N{GRINNING FACE}.gem", camera="a\x7f\x01\n\u2028b", keys={"\N{DOG}": ("F9",)})
    assert save_settings(smile, file) == ""
    assert load_settings(file) == (smile, "")
    strange = Settings({"mirror": False}, avatar=os.fsdecode(b"/caf\xe9.gem"), camera="Cam")
    assert save_settings(strange, file) == ""
    assert load_settings(file) == (replace(strange, avatar="", keys=smile.keys), "")


def test_no_output_and_no_camera_goes_on_by_itself() -> None:
    assert not {"record", "virtual_camera", "clean_window", "coefficients", "curtain", "no_badge"} & set(REMEMBERED)


@pytest.mark.parametrize(
    "content",
    [
        b"\x00\xff\xfe",
        b"[desk\n",
        b"desk = 3\n",
        b"a = " + b"[" * 5000,
        b"#" * (MAX_BYTES + 1),
        b"[desk]\nmirror = 'yes\n",
    ],
    ids=["bytes", "cut off", "another type", "deep", "large", "no string"],
)
def test_a_broken_file_is_put_aside_with_one_sentence(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "live.toml"
    file.write_bytes(content)
    settings, complaint = load_settings(file)
    assert settings == Settings()
    assert "starts afresh" in complaint
    assert "\n" not in complaint.strip()
    assert not file.exists()
    assert (tmp_path / "live.toml.broken").read_bytes() == content


def test_values_of_the_wrong_kind_or_from_another_version_are_left_out(tmp_path: Path) -> None:
    file = tmp_path / "live.toml"
    file.write_text(
        "future = 1\n[desk]\nmirror = 'no'\nsmoothing = 99\nzoom = 3.0\navatar = 7\n"
        "[window]\nwidth = -5\nheight = 3.5\n[keys]\nrecord = ['F9', 3]\nunknown = ['X']\nmirror = 'M'\n"
    )
    settings, complaint = load_settings(file)
    assert complaint == ""
    assert settings.window is None
    assert settings.avatar == ""
    assert settings.keys == {"record": ("F9",), "unknown": ("X",), "mirror": ("M",)}
    assert any("no action called 'unknown'" in complaint for complaint in keymap(settings.keys).conflicts)
    assert save_settings(settings, tmp_path / "again.toml") == ""
    assert load_settings(tmp_path / "again.toml") == (settings, "")
    state = recalled(DeskState(), settings)
    assert state == replace(DeskState(), smoothing=1.0)


def test_a_folder_or_a_disk_that_refuses_is_told(tmp_path: Path) -> None:
    (tmp_path / "live.toml").mkdir()
    assert load_settings(tmp_path / "live.toml")[0] == Settings()
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert "could not be kept" in save_settings(Settings(), blocked / "live.toml")
