"""What results are called, and whether they may be written there."""

import os
from pathlib import Path

from .errors import OutputError, UsageError
from .sinks import VIDEO_SUFFIXES


def plan_outputs(drivers: list[str], out: str, transparent: bool) -> list[tuple[str, Path]]:
    """Each driver with its result.

    One driver: ``out`` itself, a video by its suffix, else a folder of PNGs. Several drivers: ``out`` is a folder and
    holds one video each (one folder of PNGs each when transparent), named like the driver.
    Raises UsageError and OutputError.
    """
    path = Path(out)
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
        results = [path / _distinct(drivers, i, "" if transparent else ".mp4") for i in range(len(drivers))]
    for driver, result in zip(drivers, results, strict=True):
        if Path(driver).exists() and result.exists() and Path(driver).samefile(result):
            raise UsageError(f"-o {out}: would overwrite the driver {driver}; choose another name")
    return list(zip(drivers, results, strict=True))


def _distinct(drivers: list[str], index: int, suffix: str) -> str:
    """The driver's name, numbered when an earlier driver has the same."""
    stems = [Path(driver.rstrip("/\\")).stem for driver in drivers[: index + 1]]
    again = stems[:-1].count(stems[-1])
    return f"{stems[-1]}-{again + 1}{suffix}" if again else f"{stems[-1]}{suffix}"


def is_video(path: Path) -> bool:
    """Whether this result is a video file; else it is a folder of PNGs."""
    return path.suffix.lower() in VIDEO_SUFFIXES
