"""Whether an earlier run made what this one would make: by the line in a video, or the note in a folder of PNGs."""

from collections.abc import Mapping
from pathlib import Path

from .leftovers import noted
from .outputs import is_video
from .recipes import recipe_in, recipe_of


def made_of_the_same(result: Path, made_of: Mapping[str, str]) -> bool | None:
    """Whether a result was made of this; None where nothing in it says. What a note says besides is not asked."""
    if is_video(result):
        found = recipe_in(result)
        return found == recipe_of(made_of) if found else None
    note = noted(result, ".png")
    return None if note is None else {name: note.get(name) for name in made_of} == dict(made_of)
