"""The credentials of one result: signed where this computer can sign, and a sentence where it cannot."""

import os
from pathlib import Path

from ...models.wholefile import file_sha256
from ..errors import CommandError, OutputError
from ..files.sources import IMAGE_SUFFIXES, files_of, files_sha256
from .reading import read_credentials
from .signing import Signer
from .statement import Driver, Statement

SIGNED = "signed"


class Papers:
    """For one thread. Nothing here raises: a result without credentials is better than none."""

    def __init__(self, signer: Signer | None, statement: Statement) -> None:
        """``signer``: None leaves everything as it is."""
        self._signer, self._statement = signer, statement
        self.said = ""
        """"signed", or why not; empty where nothing was to be signed."""

    def sign(self, path: Path) -> str:
        """Put them into a finished video; ``said``."""
        if self._signer is not None:
            try:
                self._signer.sign(path, self._statement)
                self.said = SIGNED
            except OutputError as error:
                self.said = str(error)
        return self.said

    def sign_once(self, path: Path) -> str:
        """Put them into a finished video that an earlier run may have left without; ``said``."""
        if self._signer is None:
            return ""
        try:
            unsigned = read_credentials(path).state == "none"
        except CommandError as error:
            self.said = str(error)
            return self.said
        return self.sign(path) if unsigned else SIGNED

    def signed_png(self, png: bytes) -> bytes:
        """The bytes of a PNG with them, or as they were."""
        if self._signer is not None:
            try:
                png = self._signer.signed(png, ".png", self._statement)
                self.said = SIGNED
            except OutputError as error:
                self.said = str(error)
        return png


def driver_of(driver: str | None, track: Path | None, named: bool = False) -> Driver:
    """What may be told of a driver, a track before all else; ``named``: its file's name too. All of it is read for its
    hash."""
    file = track or (Path(driver) if driver else None)
    pictured = file is None or not file.is_file() or file.suffix.lower() in IMAGE_SUFFIXES
    kind = "track" if track else "pictures" if pictured else "video"
    name = os.fsencode(file.name).decode("utf-8", "replace") if named and file else ""
    files = [one for one in files_of(str(file)) if one.is_file()] if file else []
    if not files:
        return Driver(kind, name=name)
    try:
        return Driver(kind, file_sha256(files[0]) if files == [file] else files_sha256(files), name)
    except OSError:  # it was read a moment ago; without its hash the rest still holds
        return Driver(kind, name=name)
