"""Which avatars there are: those that ship, and those in the user's data folder."""

import os
from dataclasses import dataclass
from pathlib import Path

from .errors import InputError

SHIPPED = Path(__file__).resolve().parent.parent / "assets" / "avatars"
DEMO_CLIP = SHIPPED.parent / "demo" / "driver.mp4"
REINSTALL = "reinstall gemheads (in a clone: git checkout assets)"
"""The cure for a file that ships and is not there."""
SUFFIX = ".gem"
DEFAULT = "mara"
"""What is opened when nobody names one."""


def demo_clip() -> Path:
    """The clip of a face that ships. Raises InputError where the installation is broken."""
    if not DEMO_CLIP.is_file():
        raise InputError(f"{DEMO_CLIP}: the demo clip is missing; {REINSTALL}")
    return DEMO_CLIP


@dataclass(frozen=True)
class Entry:
    """One avatar that can be called by name."""

    name: str
    path: Path
    shipped: bool


def user_folder() -> Path:
    """Where a user's own avatars are looked for; it need not exist."""
    import platformdirs

    return Path(platformdirs.user_data_dir("gemheads", appauthor=False)) / "avatars"


def avatars(folders: tuple[tuple[Path, bool], ...] | None = None) -> list[Entry]:
    """All avatars by name, the user's own before a shipped one of the same name; ``folders``: (folder, shipped)."""
    found: dict[str, Entry] = {}
    for folder, shipped in folders or ((user_folder(), False), (SHIPPED, True)):
        # no name begins with a dot: macOS puts a ._mara.gem beside mara.gem on disks of others; a folder that may not
        # be looked at holds none
        for file in sorted(folder.glob(f"[!.]*{SUFFIX}")) if os.path.isdir(folder) else ():
            found.setdefault(file.stem, Entry(file.stem, file, shipped))
    return [found[name] for name in sorted(found)]


def find_avatar(wanted: str | None = None, entries: list[Entry] | None = None) -> Path:
    """The file of an avatar given by name or path; when none is given DEFAULT, which may be the user's, or the first
    that ships.

    Raises InputError.
    """
    entries = avatars() if entries is None else entries
    if wanted is None:
        first = sorted(entries, key=lambda entry: (entry.name != DEFAULT, not entry.shipped))
        if not first:
            raise InputError(f"no avatar in {SHIPPED}; run `make avatars`, or give --avatar FILE{SUFFIX}")
        return first[0].path
    for entry in entries:
        if entry.name == wanted:
            return entry.path
    path = Path(wanted)
    if path.exists():
        return path
    names = ", ".join(entry.name for entry in entries) or "none"
    raise InputError(f"{wanted}: neither an avatar's name (there are: {names}) nor a file; check the spelling")
