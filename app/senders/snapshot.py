"""One picture as a PNG, alpha kept: it appears whole or not at all, and never takes the place of another."""

import os
from collections.abc import Callable
from pathlib import Path

import cv2

from ...models.wholefile import settle, whose
from ...render.arrays import Image
from ..credentials.badge import badged
from ..credentials.papers import Papers
from ..credentials.signing import open_signer
from ..credentials.statement import Driver, Statement
from ..errors import OutputError
from .fitting import Size, fitted
from .folder import made
from .outlet import Shown

STEM = "gemheads"


class Snapshot:
    """An outlet that saves each picture it gets under the next free number."""

    def __init__(self, folder: Path, size: Size) -> None:
        """``size``: width and height in pixels. Raises OutputError when the folder cannot be made."""
        self._folder, self._size, self._signer = folder, size, open_signer()[0]
        self.status = "waiting for a picture"
        made(folder)

    def send(self, shown: Shown) -> None:
        """Write a picture."""
        # a slow machine draws smaller pictures meanwhile
        picture = fitted(shown.picture, self._size, None if shown.picture.shape[2] == 4 else (0, 0, 0))
        picture = picture if shown.marks.no_badge else badged(picture)
        origins = (shown.origin,) if shown.origin is not None else ()
        papers = Papers(self._signer, Statement(origins, Driver("live"), shown.marks.no_badge))
        path = save_picture(picture, self._folder, papers.signed_png)
        self.status = f"saved {path}" + (f", {papers.said}" if papers.said else "")

    def close(self) -> None:
        """Nothing is left open."""


def save_picture(picture: Image, folder: Path, signed: Callable[[bytes], bytes] = bytes) -> Path:
    """Writes a picture [H, W, 3] or [H, W, 4] with straight alpha into ``folder`` and gives its name.

    ``signed`` puts credentials into the bytes of the PNG.

    Raises OutputError; then nothing is left behind.
    """
    order = cv2.COLOR_RGBA2BGRA if picture.shape[2] == 4 else cv2.COLOR_RGB2BGR
    _, data = cv2.imencode(".png", cv2.cvtColor(picture, order))
    aside = folder / f".{STEM}.{whose()}.partial"
    try:
        try:
            aside.write_bytes(signed(data.tobytes()))
            settle(aside)
            return _named(aside, folder)
        finally:
            aside.unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(
            f"{folder}: the picture cannot be saved ({error.strerror}); free some space, or choose another folder"
        ) from error


def _named(aside: Path, folder: Path) -> Path:
    """Gives a finished file the first free number: of two programs at once, each gets its own."""
    taken = [int(digits) for file in folder.glob(f"{STEM}-*.png") if (digits := file.stem[len(STEM) + 1 :]).isdecimal()]
    number = max(taken, default=0)
    while True:
        number += 1
        path = folder / f"{STEM}-{number:04d}.png"
        try:
            os.link(aside, path)
            return path
        except FileExistsError:
            continue
        except OSError:  # a file system without links, as on memory sticks
            if not path.exists():
                return aside.replace(path)
