"""Where results go: looked at before hours are spent on them, and elsewhere if there is no room in the end."""

import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from ..errors import OutputError, UsageError
from ..library import SHIPPED, SUFFIX
from .outputs import keep_inputs
from .tensorfile import is_tensor_file


def check_avatar_name(out: Path) -> None:
    """Raises UsageError for a name that no avatar's file has."""
    if out.suffix != SUFFIX:
        raise UsageError(f"{out}: an avatar's file is called {SUFFIX}, such as -o {out.with_suffix(SUFFIX).name}")


def place_of_changed(avatar: Path, out: Path | None) -> Path:
    """Where an avatar goes that a command changes: ``out``, or over itself. Raises UsageError where that would be over
    one that ships, or where ``out`` is no name of an avatar."""
    if out is None and avatar.resolve().parent == SHIPPED:
        raise UsageError(f"{avatar}: ships with gemheads and stays as it is; give -o, such as -o my-{avatar.name}")
    check_avatar_name(out or avatar)
    return out or avatar


def check_places(*outs: Path | None, read: Iterable[Path | None] = ()) -> None:
    """Makes the folders of these files and sees that each can be written; None is a result that nobody wants.

    Args:
        outs: files that will be written.
        read: files and folders that are read, None likewise; nothing is written over them, or over what is in them,
            but for avatars and tracks, which no capture and no run consists of.

    Raises:
        OutputError: for a place that cannot be written.
        UsageError: for one that is read, or that two results want.
    """
    for out in filter(None, outs):
        try:
            if out.is_dir():
                raise OutputError(f"{out}: is a folder; name a file")
            if out.exists() and not out.is_file():
                raise OutputError(f"{out}: is a pipe or a device; name a file")
        except OSError as error:
            raise OutputError(f"{out}: cannot be written ({error.strerror}); choose another place") from error
    inputs = [*filter(None, read)]
    keep_inputs(outs, inputs)
    for folder in (one.resolve() for one in inputs if one.is_dir()):
        for out in filter(None, outs):
            if out.exists() and not is_tensor_file(out) and folder in out.resolve().parents:
                raise UsageError(f"{out}: would be written over a part of {folder}, which is read; choose another name")
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
