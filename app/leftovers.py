"""What an earlier run left in a folder of numbered files: the same run goes on with it, any other begins anew."""

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from ..models.wholefile import write_whole
from .errors import OutputError

_FRAME = re.compile(r"frame_\d{6,}")


def take_over(
    folder: Path, suffix: str, made_of: Mapping[str, str], resume: bool = False, index: Iterable[str] = ()
) -> tuple[bool, str]:
    """Make a folder ready for the files ``frame_000000`` + suffix ... of a run, and note in it what they are made of.

    Args:
        folder: is made where it is missing.
        suffix: of the files, with its dot.
        made_of: everything that decides what is in the files: names that people understand, and values.
        resume: keep the files that are there if they are made of the same; else they are removed.
        index: names of files that list the others, removed before them.

    Returns:
        Whether they are kept, and, where ``resume`` asked for it in vain, a sentence that says why not; else "".

    Raises:
        OutputError: when it cannot be written, or holds such files that no run has noted: they may be somebody's own.
    """
    note = folder / f".made-of{suffix}.json"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        left = [file for file in folder.iterdir() if file.suffix == suffix and _FRAME.fullmatch(file.stem)]
        former = _read(note)
        if left and former is None:
            raise OutputError(
                f"{folder}: holds {min(left).name}, and nothing says which run made it; choose another folder, or"
                f" remove its frame_*{suffix}"
            )
        if resume and former == made_of:
            return True, ""
        for name in index:
            (folder / name).unlink(missing_ok=True)
        for file in left:
            file.unlink()
        write_whole(note, [json.dumps(dict(made_of), indent=1).encode()])
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written ({error.strerror}); check the folder and the space") from error
    if not resume or not left or former is None:
        return False, ""
    others = ", ".join(name for name in made_of if former.get(name) != made_of[name]) or "version of gemheads"
    return False, f"{folder}: the files that were there are of another {others}; begun anew"


def _read(note: Path) -> dict[str, str] | None:
    """None where there is no note; nothing is like one that is broken."""
    if not note.is_file():
        return None
    try:
        told = json.loads(note.read_text("utf-8"))
    except ValueError:
        return {}
    return told if isinstance(told, dict) else {}
