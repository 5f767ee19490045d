"""What results are called, and whether they may be written there."""

import errno
import itertools
import os
from collections.abc import Iterable
from pathlib import Path

from ..errors import OutputError, UsageError
from .pictures import drawn_here
from .recipes import recipe_in
from .sinks import FRAME_NAME, VIDEO_SUFFIXES, partial_name


def plan_outputs(drivers: list[str], out: str, transparent: bool) -> list[tuple[str, Path]]:
    """Each driver with its result.

    One driver: ``out`` itself, a video by its suffix, else a folder of PNGs. Several drivers: ``out`` is a folder and
    holds one video each (one folder of PNGs each when transparent), named like the driver.
    Raises UsageError and OutputError.
    """
    path = Path(out)
    if not out:
        raise UsageError("-o '': names nothing; name a video or a folder")
    if len(drivers) == 1:
        if path.suffix and path.suffix.lower() not in VIDEO_SUFFIXES and not path.is_dir() and not out.endswith(os.sep):
            raise UsageError(
                f"-o {out}: cannot write {path.suffix}; end it in {', '.join(VIDEO_SUFFIXES)}, or name a folder"
            )
        if path.suffix.lower() in VIDEO_SUFFIXES and path.is_dir():
            raise OutputError(f"{out}: is a folder; choose another name for the video")
        results = [path]
    else:
        if path.suffix.lower() in VIDEO_SUFFIXES or path.is_file():
            raise UsageError(f"-o {out}: with {len(drivers)} drivers the result is a folder; name one")
        results = [path / name for name in _distinct(drivers, transparent)]
    return list(zip(drivers, results, strict=True))


def keep_inputs(outs: Iterable[Path | None], inputs: Iterable[Path | None]) -> None:
    """Sees that nothing which is read is written over by results, under their own or their unfinished name, and no
    result by another.

    Args:
        outs: files, or folders that PNGs go into; None is a result that nobody wants.
        inputs: files and folders that are read; None likewise.

    Raises:
        UsageError: naming both.
    """
    known = {_identity(file): file for file in filter(None, inputs) if file.exists()}
    frames = [file for file in known.values() if FRAME_NAME.fullmatch(file.name)]
    taken: dict[Path, Path] = {}  # every name that a result has, unfinished ones too
    for out in filter(None, outs):
        place = out.resolve()  # through folders that are not there yet
        names = (place, partial_name(place)) if place.name else (place,)
        read = [known[one] for one in (_identity(name) for name in names if _is_there(name)) if one in known]
        if _is_there(place) and place.is_dir():
            read += [file for file in frames if file.parent.samefile(place)]
        if read:
            raise UsageError(f"{out}: would be written over {read[0]}, which is read; choose another name")
        if any(taken.setdefault(name, out) is not out for name in names):
            raise UsageError(f"{out}: two results would have this name; choose another one")


def keep_strangers(outs: Iterable[Path | None]) -> None:
    """Sees that no video and no PNG is written over which no run made: for files whose names nobody typed.

    Raises OutputError, naming it.
    """
    for out in filter(None, outs):
        if _is_there(out) and _is_strange(out):
            passed_by = " (--resume passes it by)" if is_video(out) else ""
            raise OutputError(
                f"{out}: is there already, and nothing in it says that a run made it; choose another folder, or rename"
                f" it{passed_by}"
            )


def _is_strange(out: Path) -> bool:
    """Whether a file that is there does not say that a run made it."""
    if is_video(out):
        return not recipe_in(out)
    try:
        return out.is_file() and not drawn_here(out)
    except OSError:  # what nobody may read is not ours
        return True


def _is_there(path: Path) -> bool:
    """A name that is too long for the disk is not; where nobody may look, that is for whoever asked to hear."""
    try:
        return path.exists()
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            return False
        raise


def _identity(file: Path) -> tuple[int, int]:
    """The same for all names of one file."""
    status = file.stat()
    return status.st_dev, status.st_ino


def _distinct(drivers: list[str], folders: bool) -> list[str]:
    """The drivers' names, numbered where they meet; capitals alone keep none apart on every disk.

    Videos end in .mp4; what is a folder does not look like a video.
    """
    names: list[str] = []
    taken: set[str] = set()
    for driver in drivers:
        stem = Path(driver.rstrip("/\\")).stem or Path(driver).resolve().stem
        if folders and is_video(Path(stem)):
            stem = stem.replace(".", "_")
        tries = (stem if number == 1 else f"{stem}-{number}" for number in itertools.count(1))
        name = next(name for name in tries if not {name.casefold(), f"{name}.partial".casefold()} & taken)
        taken |= {name.casefold(), f"{name}.partial".casefold()}
        names.append(name if folders else f"{name}.mp4")
    return names


def is_video(path: Path) -> bool:
    """Whether this result is a video file; else it is a folder of PNGs."""
    return path.suffix.lower() in VIDEO_SUFFIXES
