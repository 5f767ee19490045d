"""What an earlier run left in a folder of numbered files: the same run goes on with it, any other begins anew."""

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from ...models.wholefile import write_whole
from ..errors import OutputError, cannot_write

_FRAME = re.compile(r"frame_\d{6,}")
_TORN = re.compile(r"\.frame_\d{6,}\.\w+\.[\d-]+\.partial")
"""What a run that was killed had begun to write."""


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
        OutputError: when it cannot be written, or holds such files, or a list of that name, that no run has noted: they
            may be somebody's own.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for file in folder.iterdir():
            if _TORN.fullmatch(file.name):
                file.unlink()
        left = [file for file in folder.iterdir() if file.suffix == suffix and _FRAME.fullmatch(file.stem)]
        former = noted(folder, suffix)
        lists = [folder / name for name in index if (folder / name).exists()]
        if former is None and (left or lists):
            strange, cure = (min(left), f"remove its frame_*{suffix}") if left else (lists[0], "rename it")
            raise OutputError(
                f"{folder}: holds {strange.name}, and nothing says which run made it; choose another folder, or {cure}"
            )
        if resume and former == made_of:
            return True, ""
        for file in (*lists, *left):
            file.unlink()
        write_whole(_note(folder, suffix), [json.dumps(dict(made_of), indent=1).encode()])
    except OSError as error:
        raise cannot_write(folder, error) from error
    if not resume or not left or former is None:
        return False, ""
    others = ", ".join(name for name in made_of if former.get(name) != made_of[name]) or "version of gemheads"
    return False, f"{folder}: the files that were there are of another {others}; begun anew"


def noted(folder: Path, suffix: str) -> dict[str, str] | None:
    """What the files of a folder are made of, as the run that made them noted it. None where there is no note; nothing
    is like one that is broken."""
    note = _note(folder, suffix)
    if not note.is_file():
        return None
    try:
        told = json.loads(note.read_text("utf-8"))
    except ValueError:
        return {}
    return told if isinstance(told, dict) else {}


def _note(folder: Path, suffix: str) -> Path:
    return folder / f".made-of{suffix}.json"
