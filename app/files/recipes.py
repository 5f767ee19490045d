"""What a video was made of, as one line in its file: whether an earlier run made what this one would make."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from ..errors import CommandError
from .video import open_container

KEY = "comment"
"""Of the file's metadata: every container has it."""
_MARK = "gemheads recipe "


def recipe_of(made_of: Mapping[str, str]) -> str:
    """The line for everything that decides what is in a video: names and values. It tells nobody what they are."""
    return _MARK + hashlib.sha256(json.dumps(dict(made_of), sort_keys=True).encode()).hexdigest()


def recipe_in(video: Path) -> str:
    """The line in a file; empty where there is none, or where it is no video."""
    try:
        with open_container(video) as container:
            told = str(container.metadata.get(KEY, container.metadata.get(KEY.upper(), "")))
    except CommandError:
        return ""
    return told if told.startswith(_MARK) else ""
