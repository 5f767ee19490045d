"""Captures as commands meet them: whether a path is one, opened, and which of its pictures are meant."""

from collections.abc import Sequence
from pathlib import Path

from ...models.captures.heldout import spread
from ...models.captures.layout import SPLITS, CaptureError, Shot, transforms_name
from ...models.captures.reader import Capture, open_capture
from ..errors import InputError, UsageError


def is_capture(path: Path) -> bool:
    """Whether it is the folder of a capture, sound or not."""
    return (path / transforms_name("train")).is_file()


def is_run(path: Path) -> bool:
    """Whether it is the folder of a training run, sound or not."""
    return (path / "config.json").is_file()


def opened(path: Path) -> Capture:
    """A capture, everything in it checked. Raises InputError."""
    try:
        return open_capture(path)
    except CaptureError as error:
        raise InputError(str(error)) from error


def chosen(capture: Capture, split: str, cameras: str | None) -> list[Shot]:
    """The pictures of a split from the cameras that are named ("0,3"), or from VIEWS of them. Raises UsageError."""
    if split not in SPLITS:
        raise UsageError(f"--split {split}: choose from {', '.join(SPLITS)}")
    shots = capture.shots(split)
    if not shots:
        raise UsageError(f"--split {split}: {capture.folder} has no such pictures; choose another")
    there = sorted({shot.camera_index for shot in shots})
    wanted = spread(there) if cameras is None else _named(cameras, there)
    return [shot for shot in shots if shot.camera_index in wanted]


def _named(cameras: str, there: Sequence[int]) -> set[int]:
    words = [word.strip() for word in cameras.split(",") if word.strip()]
    numbers = {int(word) for word in words if word.isascii() and word.isdigit() and len(word) < 10}
    if not words or len(numbers) < len(set(words)) or not numbers <= set(there):
        raise UsageError(f"--cameras {cameras}: choose from {','.join(map(str, there))}")
    return numbers
