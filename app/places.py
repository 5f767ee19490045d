"""Where results go: looked at before hours are spent on them, and elsewhere if there is no room in the end."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from .errors import OutputError


def check_places(*outs: Path | None) -> None:
    """Makes the folders of these files and sees that each can be written; None is a result that nobody wants.

    Raises OutputError.
    """
    for out in outs:
        if out is not None and out.is_dir():
            raise OutputError(f"{out}: is a folder; name a file")
    for folder in dict.fromkeys(out.parent for out in outs if out is not None):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError as error:
            raise OutputError(f"{folder}: cannot be written ({error.strerror}); choose another folder") from error


def save_learned(save: Callable[[Path], None], out: Path) -> None:
    """Save what took hours to ``out``; where that cannot be written any more, into a new folder for temporary files.

    Raises OutputError that says where it is, or that it is lost.
    """
    try:
        save(out)
    except OSError as error:
        what = f"{out}: cannot be written ({error.strerror})"
        kept = _saved_elsewhere(save, out.name)
        if kept is None:
            raise OutputError(f"{what}; check the folder and the space, and run again") from error
        raise OutputError(f"{what}; it is whole, and kept as {kept}: free some space and move it there") from error


def _saved_elsewhere(save: Callable[[Path], None], name: str) -> Path | None:
    """Where; None where there is no room either."""
    try:
        folder = Path(tempfile.mkdtemp(prefix="gemheads-"))
    except OSError:
        return None
    try:
        save(folder / name)
    except OSError:
        shutil.rmtree(folder, ignore_errors=True)
        return None
    return folder / name
