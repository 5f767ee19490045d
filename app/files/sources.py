"""Drivers: video files, folders of images, numbered sequences and single pictures, all as frames with timestamps."""

import glob
import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from ...models.picturefile import decode_picture, is_animation
from ...models.videopicture import LONGEST_SIDE
from ...models.wholefile import file_sha256, open_ordinary
from ..errors import InputError
from .crop import WHOLE, Crop
from .frames import Frame, spread
from .video import VideoFile, check_sides

IMAGE_SUFFIXES = frozenset({".png", ".jpg", ".jpeg", ".webp", ".bmp", ".tif", ".tiff"})
MAX_PICTURE_BYTES = 2**28
_NUMBER = re.compile(r"%0?\d*d")
"""As printf writes it."""


class Source(Protocol):
    """What every driver offers; it can be read any number of times."""

    @property
    def path(self) -> Path:
        """Where it came from."""
        ...

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels, upright."""
        ...

    @property
    def time_base(self) -> Fraction:
        """Seconds per unit of the frames' timestamps."""
        ...

    @property
    def rate(self) -> Fraction:
        """Frames per second, on average."""
        ...

    @property
    def frame_count(self) -> int | None:
        """How many frames to expect, where known; a hint for the progress bar."""
        ...

    def frames(self) -> Iterator[Frame]:
        """All frames in order. Raises InputError when there is none or the data cannot be read."""
        ...

    def samples(self, count: int) -> list[Frame]:
        """Up to ``count`` frames spread over the whole, in order."""
        ...


class Images:
    """Pictures in a given order, at a constant rate."""

    def __init__(self, path: Path, files: list[Path], rate: Fraction, longest_side: int, crop: Crop = WHOLE) -> None:
        """``longest_side``: larger pictures are scaled down to this, after they were cropped. Raises InputError."""
        self.path = path
        self.files = files
        self.rate = rate
        self.time_base = 1 / rate
        self.frame_count: int | None = len(files)
        self._longest_side, self._crop = longest_side, crop
        height, width = self._read(files[0]).shape[:2]
        self.size = (width, height)

    def frames(self) -> Iterator[Frame]:
        """All pictures; raises InputError for one that cannot be read."""
        for index, file in enumerate(self.files):
            yield Frame(self._read(file), index, self.time_base)

    def samples(self, count: int) -> list[Frame]:
        """Up to ``count`` pictures, evenly spread."""
        chosen = spread(len(self.files), count)
        return [Frame(self._read(self.files[i]), i, self.time_base, number=i) for i in chosen]

    def _read(self, file: Path) -> NDArray[np.uint8]:
        image = self._crop.of(read_image(file))
        height, width = image.shape[:2]
        check_sides(file, (width, height), self._crop)
        scale = self._longest_side / max(height, width)
        if scale >= 1:
            return image
        size = max(1, round(width * scale)), max(1, round(height * scale))
        return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)


def read_image(path: Path) -> NDArray[np.uint8]:
    """[H, W, 3] sRGB of one picture, turned upright by its EXIF tag. Raises InputError."""
    # on bytes, not by name: file names outside the system's code page work everywhere
    try:
        with open_ordinary(path) as (file, size):
            if size > MAX_PICTURE_BYTES:
                raise InputError(f"{path}: larger than {MAX_PICTURE_BYTES >> 20} MB; convert it to JPEG")
            content = file.read(size)
    except OSError as error:
        said = error.strerror or error
        raise InputError(f"{path}: cannot be read ({said}); check the path and its permissions") from error
    if is_animation(content):
        raise InputError(f"{path}: is an animation, of which one picture would be read; convert it to mp4")
    image = decode_picture(content)
    if image is None:
        raise InputError(f"{path}: is not a picture that can be decoded; convert it to PNG or JPEG")
    check_sides(path, (image.shape[1], image.shape[0]))
    return np.asarray(image, np.uint8)


def open_source(
    driver: str, rate: Fraction = Fraction(30), longest_side: int = LONGEST_SIDE, crop: Crop = WHOLE
) -> Source:
    """The driver behind a command-line word: a video, a picture, a folder of pictures, ``shot_*.png`` or ``%04d.png``.

    ``rate`` (frames per second) is for pictures, which carry no time, and so is ``longest_side``, beyond which they are
    scaled down (pixels); that of videos is LONGEST_SIDE. ``crop``: what of the pictures is shown. Raises InputError.
    """
    path = Path(driver)
    if path.is_dir():
        files = _pictures_in(path)
        if not files:
            raise InputError(
                f"{path}: a folder without pictures; it needs files ending in {', '.join(sorted(IMAGE_SUFFIXES))}"
            )
        return Images(path, files, rate, longest_side, crop)
    if path.is_file():
        if path.suffix.lower() in IMAGE_SUFFIXES:
            return Images(path, [path], rate, longest_side, crop)
        return VideoFile(path, crop)
    files = _sequence(path)
    if files:
        return Images(path, files, rate, longest_side, crop)
    if path.exists():
        raise InputError(f"{path}: a pipe or device, and a driver is read twice; save it as a file first")
    raise InputError(f"{path}: no such file or folder; check the path")


def have_times(drivers: Iterable[str]) -> bool:
    """Whether all of these command-line words are videos, which have times of their own."""
    return all(os.path.isfile(driver) and Path(driver).suffix.lower() not in IMAGE_SUFFIXES for driver in drivers)


def files_of(driver: str) -> list[Path]:
    """What is read for a command-line word: files, after the folder that they are in; nothing where there is none, or
    where it may not be looked at."""
    path = Path(driver)
    if os.path.isdir(path):
        return [path, *_pictures_in(path)] if os.access(path, os.R_OK | os.X_OK) else [path]
    return [path] if os.path.isfile(path) else _sequence(path)


def files_sha256(files: Iterable[Path]) -> str:
    """One for all of these files: of their own, in hexadecimal and one behind the other; folders among them are passed
    over. Raises OSError."""
    return hashlib.sha256("".join(file_sha256(file) for file in files if file.is_file()).encode()).hexdigest()


def _pictures_in(folder: Path) -> list[Path]:
    visible = (f for f in folder.iterdir() if not f.name.startswith("."))  # macOS puts a ._shot.png beside shot.png
    return _in_reading_order(f for f in visible if f.suffix.lower() in IMAGE_SUFFIXES)


def _sequence(path: Path) -> list[Path]:
    """The files a pattern names: shell wildcards, or one printf number such as %d or %05d."""
    numbered = re.compile(_NUMBER.sub(r"\\d+", re.escape(path.name))) if _NUMBER.search(path.name) else None
    pattern = _NUMBER.sub("*", glob.escape(path.name)) if numbered else path.name
    if not any(c in pattern for c in "*?["):
        return []
    found = (Path(f) for f in glob.glob(str(Path(glob.escape(str(path.parent))) / pattern)))
    named = (f for f in found if numbered is None or numbered.fullmatch(f.name))
    return _in_reading_order(f for f in named if f.suffix.lower() in IMAGE_SUFFIXES)


def _in_reading_order(files: Iterator[Path]) -> list[Path]:
    """Sorted so that frame2 comes before frame10."""

    def key(file: Path) -> list[tuple[bool, int, str]]:
        parts = re.split(r"(\d+)", file.name)
        return [(part.isdecimal(), int(part) if part.isdecimal() else 0, part) for part in parts]

    return sorted(files, key=key)
