"""Where results go: looked at before hours are spent on them."""

import tempfile
from pathlib import Path

from .errors import OutputError


def check_places(*outs: Path | None) -> None:
    """Makes the folders of these files and sees that each can be written; None is a result that nobody wants.

    Raises OutputError.
    """
    for folder in dict.fromkeys(out.parent for out in outs if out is not None):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError as error:
            raise OutputError(f"{folder}: cannot be written ({error.strerror}); choose another folder") from error
