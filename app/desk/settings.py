"""What the window remembers from one run to the next: a TOML file that a person may edit, or delete."""

import json
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import date, time
from pathlib import Path
from typing import Any

from ...models.wholefile import open_ordinary, write_whole
from .actions import Order
from .state import DeskState, update

MAX_BYTES = 64 * 1024
SMALLEST, LARGEST = 320, 16384
REMEMBERED = (
    "mirror",
    "figures",
    "ladder",
    "head_pose",
    "smoothing",
    "neutral_strength",
    "gain_mouth",
    "gain_eyes",
    "gain_brows",
    "gain_head",
    "background",
    "exposure",
    "warmth",
    "ui_scale",
    "camera_badge",
)
"""Fields of DeskState. Outputs are not among them: none goes on by itself."""
_OWN = (*REMEMBERED, "avatar", "camera")


@dataclass(frozen=True)
class Settings:
    """What is remembered."""

    wishes: Mapping[str, float | str | bool] = field(default_factory=dict)
    """Some of REMEMBERED, each with its value."""
    avatar: str = ""
    """Name or path; empty for the first shipped one."""
    camera: str = ""
    """The camera's name; it is only ever opened when asked for."""
    window: tuple[int, int] | None = None
    """Width and height in screen units; None at the first run."""
    keys: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Action -> the keys a person gave it; what is no action is kept, too, and the keymap complains of it."""


def settings_file() -> Path:
    """Where they are; it need not exist."""
    import platformdirs

    return Path(platformdirs.user_config_dir("gemheads", appauthor=False)) / "live.toml"


def load_settings(path: Path) -> tuple[Settings, str]:
    """What is remembered, and one sentence when the file could not be used: then it is put aside, and defaults hold."""
    if not path.exists():
        return Settings(), ""
    try:
        return _checked(_read(path)), ""
    except (OSError, ValueError, RecursionError) as error:  # TOMLDecodeError and UnicodeDecodeError are ValueErrors
        return Settings(), f"The settings could not be read ({error}); {_put_aside(path)}, and this run starts afresh."


def save_settings(settings: Settings, path: Path) -> str:
    """Write them whole; one sentence when that fails, else an empty one.

    What a person wrote into the file meanwhile stays, all but comments: keys, and whatever is not known here.
    """
    written, complaint = _written(path)
    window = {} if settings.window is None else {"width": settings.window[0], "height": settings.window[1]}
    kept = {name: value for name, value in written.get("desk", {}).items() if name not in _OWN}
    own = {name: list(keys) for name, keys in settings.keys.items()}
    sections = {
        **{name: value for name, value in written.items() if isinstance(value, dict)},
        "desk": {**kept, **settings.wishes, "avatar": settings.avatar, "camera": settings.camera},
        "window": {**written.get("window", {}), **window},
        "keys": written.get("keys", {}) if written else own,
    }
    lines = ["# What `gemheads live` remembers. Delete this file to start afresh."]
    lines += [f"{_key(name)} = {_toml(value)}" for name, value in written.items() if not isinstance(value, dict)]
    for section, values in sections.items():
        told = (f"{_key(name)} = {_toml(value)}" for name, value in sorted(values.items()) if _sayable(value))
        lines += ["", f"[{_key(section)}]", *told]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, ["\n".join([*lines, ""]).encode()])
    except OSError as error:
        return f"The settings could not be kept: {path}: {error.strerror or error}."
    return complaint


def _written(path: Path) -> tuple[dict[str, Any], str]:
    """What is in the file now, and one sentence where it cannot be read any more, and was put aside."""
    try:
        read = _read(path)
        _checked(read)
    except FileNotFoundError:
        return {}, ""
    except (OSError, ValueError, RecursionError) as error:
        return {}, f"The settings file was changed and could not be read ({error}); {_put_aside(path)}."
    return read, ""


def _read(path: Path) -> dict[str, Any]:
    with open_ordinary(path) as (file, size):
        if size > MAX_BYTES:
            raise ValueError(f"{size} bytes are more than settings take")
        return tomllib.loads(file.read(MAX_BYTES).decode())


def recalled(state: DeskState, settings: Settings) -> DeskState:
    """The state with what is remembered; every value goes through the same door as an order."""
    for name, value in settings.wishes.items():
        state = update(state, Order(name, float(value) if isinstance(value, bool) else value))
    return state


def remembered(state: DeskState, settings: Settings) -> Settings:
    """The settings with what the state says."""
    return replace(settings, wishes={name: getattr(state, name) for name in REMEMBERED})


def _checked(read: Mapping[str, object]) -> Settings:
    desk, window, keys = (_table(read, name) for name in ("desk", "window", "keys"))
    wishes: dict[str, float | str | bool] = {}
    for name in REMEMBERED:
        value, default = desk.get(name), getattr(DeskState(), name)
        if isinstance(value, str if isinstance(default, str) else int | float):
            wishes[name] = value  # pyright: ignore[reportArgumentType]
    size = [window.get("width"), window.get("height")]
    fits = all(isinstance(side, int) and SMALLEST <= side <= LARGEST for side in size)
    own = {
        name: tuple(key for key in (theirs if isinstance(theirs, list) else [theirs]) if isinstance(key, str))
        for name, theirs in keys.items()
    }
    avatar, camera = (value if isinstance(value := desk.get(name, ""), str) else "" for name in ("avatar", "camera"))
    return Settings(wishes, avatar, camera, (size[0], size[1]) if fits else None, own)  # pyright: ignore


def _table(read: Mapping[str, object], name: str) -> Mapping[str, object]:
    value = read.get(name, {})
    if not isinstance(value, dict):
        raise ValueError(f"{name} is no table")
    return value


def _put_aside(path: Path) -> str:
    aside = path.with_name(path.name + ".broken")
    try:
        os.replace(path, aside)
    except OSError:
        return f"{path} stays as it is"
    return f"they are kept as {aside}"


def _key(name: str) -> str:
    """What a person wrote may be no bare key."""
    return name if re.fullmatch("[A-Za-z0-9_-]+", name) else _quoted(name)


def _sayable(value: object) -> bool:
    """TOML is UTF-8; names of files and cameras may be any bytes, which Python keeps as surrogates."""
    return not isinstance(value, str) or not re.search("[\ud800-\udfff]", value)


def _quoted(text: str) -> str:
    """A TOML basic string: JSON's, but for the one control character that JSON leaves as it is."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(name)} = {_toml(item)}" for name, item in value.items()) + "}"
    if isinstance(value, date | time):  # a datetime is a date
        return value.isoformat()
    if isinstance(value, list):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    if isinstance(value, str):
        return _quoted(value)
    return str(value).lower() if isinstance(value, bool) else repr(value)
