"""Where recordings and pictures go: a folder that is made when the first one is written."""

from pathlib import Path

from ..errors import OutputError


def made(folder: Path) -> Path:
    """The folder, made where it was not there. Raises OutputError when that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(
            f"{folder}: cannot be made ({error.strerror}); see that {folder.parent} is a folder that you may write to"
        ) from error
    return folder
