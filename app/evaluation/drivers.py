"""The people who drive avatars in ``evaluate``: their clips, opened, named, and tracked once."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...models.crossing.clip import Clip, ShortClip, UnseenDriver, track_clip
from ...models.crossing.kept import Kept
from ...models.crossing.still import CONDITIONS, Still, hold_still
from ...models.driver.features import FEATURE_VERSION
from ...models.wholefile import file_sha256
from ...render.arrays import Image
from ..errors import InputError, NoFaceError, UsageError
from ..files.sources import Images, Source, open_source


@dataclass(frozen=True)
class Driver:
    """One clip of a person."""

    name: str
    source: Source
    sha256: str
    """Of what it shows: the bytes of its file or of all its pictures."""

    def frames(self) -> Iterator[tuple[Image, float]]:
        """Pictures and times in seconds. Raises InputError."""
        return ((frame.rgb, frame.seconds) for frame in self.source.frames())

    def tracked(self, every: int, seconds: float, kept: Kept) -> "Tracked":
        """The clip as readings. Raises InputError, also for too few frames, NoFaceError when too few of them show a
        face, OSError."""
        made_of = [self.sha256, every, seconds, FEATURE_VERSION]
        try:
            clip = kept.get("clip", made_of, Clip, lambda: track_clip(self.frames(), every, seconds))
        except ShortClip as error:
            asked, cure = (
                f"--every {every}, --seconds {seconds:g}",
                "give a longer clip, more --seconds, a smaller --every",
            )
            raise InputError(f"{self.source.path}: {error} ({asked}); {cure}") from error
        except UnseenDriver as error:
            cure = "give a longer clip that shows a face, or a smaller --every"
            raise NoFaceError(f"{self.source.path}: {error}; {cure}") from error
        return Tracked(self, clip, made_of)


@dataclass(frozen=True)
class Tracked:
    """A driver and what was read off him."""

    driver: Driver
    clip: Clip
    made_of: list[object]
    """What the readings depend on."""

    @property
    def name(self) -> str:
        """The driver's."""
        return self.driver.name

    def still(self, kept: Kept) -> Still | None:
        """At his neutral under a webcam's noise; None where the tracker loses him there. Raises InputError, OSError."""
        try:
            return kept.get(
                "still", [*self.made_of, *CONDITIONS], Still, lambda: hold_still(self.clip, self.driver.frames())
            )
        except UnseenDriver:
            return None


def opened_drivers(words: Sequence[str]) -> list[Driver]:
    """All drivers, each looked into, so that what cannot be used is told before anything begins.

    Raises InputError, and UsageError for one that is given twice.
    """
    drivers: list[Driver] = []
    for word in words:
        source = open_source(word)
        sha256 = _sha256(source)
        if any(other.sha256 == sha256 for other in drivers):
            raise UsageError(f"--drivers {word}: is given twice; each driver is one column")
        drivers.append(Driver(_name(source.path, {other.name for other in drivers}), source, sha256))
    return drivers


def _sha256(source: Source) -> str:
    files = source.files if isinstance(source, Images) else [source.path]
    try:
        hashes = [file_sha256(file) for file in files]
    except OSError as error:
        raise InputError(f"{source.path}: cannot be read ({error.strerror}); check its permissions") from error
    return hashes[0] if len(hashes) == 1 else hashlib.sha256("".join(hashes).encode()).hexdigest()


def _name(path: Path, taken: set[str]) -> str:
    """The file's, with a number where two are called the same."""
    short = path.resolve().stem
    names = (short, *(f"{short} ({number})" for number in range(2, len(taken) + 3)))
    return next(name for name in names if name not in taken)
