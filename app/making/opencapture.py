"""Captures as commands meet them: whether a path is one, opened, and which of its pictures are meant."""

import sys
from collections.abc import Sequence
from pathlib import Path

from ...models.captures.ground import room_behind
from ...models.captures.heldout import spread
from ...models.captures.layout import IMAGES, SPLITS, TEMPLATE, CaptureError, Shot, transforms_name
from ...models.captures.reader import Capture, open_capture
from ..errors import InputError, UsageError


def is_capture(path: Path) -> bool:
    """Whether it is the folder of a capture, sound or not."""
    return (path / transforms_name("train")).is_file()


def is_unfinished(path: Path) -> bool:
    """Whether it is the folder of a capture whose list of pictures, which is written last, is not there yet."""
    return (path / TEMPLATE).is_file() and (path / IMAGES).is_dir() and not is_capture(path)


def is_run(path: Path) -> bool:
    """Whether it is the folder of a training run, sound or not."""
    return (path / "config.json").is_file()


def opened(path: Path) -> Capture:
    """A capture, everything in it checked; says where a room would be learned as the person. Raises InputError."""
    try:
        capture = open_capture(path)
        tell_of_rooms(capture)
    except CaptureError as error:
        raise InputError(str(error)) from error
    return capture


def tell_of_rooms(capture: Capture) -> None:
    """A line on stderr where pictures have no masks and more than the background behind the person."""
    picture = room_behind(capture)
    if picture is not None:
        colour = "#" + "".join(f"{round(255 * value):02x}" for value in capture.background)
        print(
            f"{picture}: has no mask, and what is behind the person is not {colour}: it is taken for the person; "
            'give masks (fg_mask_path), or state the "background"',
            file=sys.stderr,
        )


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
