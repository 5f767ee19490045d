"""Recording what the window shows, at the times of the wall clock; a killed program leaves a file that plays."""

import os
from datetime import datetime
from fractions import Fraction
from pathlib import Path

from ..credentials.badge import badged
from ..credentials.origin import Origin
from ..credentials.papers import Papers
from ..credentials.signing import open_signer
from ..credentials.statement import Driver, Statement
from ..errors import OutputError, UsageError
from ..files.claim import TakenError
from ..files.sinks import FolderSink, Sink, VideoSink
from .fitting import Size, even, fitted
from .microphone import Microphone
from .outlet import Shown

TIME_BASE = Fraction(1, 90000)
RECORDING_DEPTH = 8
"""Pictures that may wait for the encoder before some are dropped."""
MOST_DUE, ALMOST = 2.0, 0.9
"""Pictures that the rate allows are saved up to this many, and taken when almost a whole one is due: one that comes a
little early because the one before was late is no picture too many."""
_BLACK = (0, 0, 0)


class Recording:
    """An outlet into a video, or a folder of PNGs, of one size and one rate at most.

    A picture keeps the time at which it was shown, counted from the first. Of those that come faster than the rate
    allows some are left out: a fast window does not make a larger file.
    """

    def __init__(
        self,
        path: Path,
        size: Size,
        rate: int,
        transparent: bool = False,
        microphone: Microphone | None = None,
        note: str = "",
    ) -> None:
        """Opens the result under a partial name.

        Args:
            path: .mp4, .mov or .webm, else a folder of PNGs; only .mov, .webm and PNGs keep alpha. Must not exist.
            size: width and height in pixels, whatever the window does; an odd last row or column goes.
            rate: pictures a second, at most.
            transparent: keep alpha.
            microphone: sound beside the pictures; closed with the recording.
            note: what the person has to know beside the status.

        Raises:
            OutputError: when it cannot be written.
            TakenError: when it is there already, or somebody else is writing it.
            UsageError: when this kind of file cannot keep alpha, or sound.
        """
        self.path = path
        self._size, self._rate, self._backdrop = even(size), rate, None if transparent else _BLACK
        self._microphone, self._note = microphone, f" ({note})" if note else ""
        self._start: float | None = None
        self._due, self._looked = 1.0, 0.0
        self._count, self._seconds, self._failed = 0, 0.0, False
        self._signer = open_signer()[0]
        self._origins: dict[str, Origin] = {}
        self._no_badge = self._signed = ""
        try:
            self._sink = self._opened(transparent)
        except BaseException:
            if microphone is not None:
                microphone.close(False)
            raise
        self.status = f"recording{self._note}"

    def send(self, shown: Shown) -> None:
        """Encode one picture."""
        if self._start is None:
            self._start = shown.shown_at
            if self._microphone is not None:
                self._microphone.begin(shown.shown_at)
        seconds = shown.shown_at - self._start
        self._due = min(MOST_DUE, self._due + (seconds - self._looked) * self._rate)
        self._looked = seconds
        if self._due < ALMOST:
            return
        self._due -= 1
        picture = shown.picture
        if picture.shape[2] == 4 and self._backdrop is not None:  # it was begun before a background that has none
            picture = fitted(picture, picture.shape[1::-1], shown.marks.ground)
        picture = fitted(picture, self._size, self._backdrop)
        if shown.origin is not None:
            self._origins[shown.avatar] = shown.origin
        self._no_badge = shown.marks.no_badge or self._no_badge
        if not shown.marks.no_badge:
            picture = badged(picture)
        self._failed = True
        self._sink.write(self._count, picture, round(seconds / TIME_BASE))
        self._failed = False
        self._seconds = seconds
        self._count += 1
        self.status = f"recording {self._seconds:.0f} s, {self._megabytes():.1f} MB{self._note}"

    def close(self) -> None:
        """Finish the file and give it its name; one that failed keeps the partial name, and of no picture nothing is
        left."""
        try:
            self._sink.close(whole=self._count > 0 and not self._failed)
        finally:
            kept = self.path if self.path.exists() else self._sink.partial
            if self._count == 0:
                self._remove_empty()
        if self.path.is_file():
            self._signed = self._papers().sign(self.path)
        size = f"{self._megabytes():.1f} MB"
        self.status = f"saved {kept}: {self._seconds:.1f} s, {size}" if self._count else "nothing was recorded"
        self.status += f", {self._signed}" if self._signed else ""

    def _opened(self, transparent: bool) -> Sink:
        if self.path.exists():
            raise TakenError(f"{self.path}: is there already; a recording never overwrites, choose another name")
        if not self.path.suffix:
            if self._microphone is not None:
                raise UsageError(f"{self.path}: PNGs hold no sound; turn the microphone off, or name a video")
            return FolderSink(self.path, TIME_BASE, False, lambda png: self._papers().signed_png(png))
        sound = self._microphone.into if self._microphone is not None else None
        return VideoSink(self.path, self._size, TIME_BASE, Fraction(self._rate), transparent, sound)

    def _papers(self) -> Papers:
        """What is signed: all avatars that were seen, and that a badge was missing, if only for a moment."""
        return Papers(self._signer, Statement(tuple(self._origins.values()), Driver("live"), self._no_badge))

    def _megabytes(self) -> float:
        for path in (self.path, self._sink.partial):
            if path.is_file():
                return path.stat().st_size / 1e6
        return 0.0

    def _remove_empty(self) -> None:
        partial = self._sink.partial
        if partial.is_dir():
            if not os.listdir(partial):
                partial.rmdir()
        else:
            partial.unlink(missing_ok=True)


def open_recording(path: Path, size: Size, rate: int, transparent: bool = False, microphone: bool = False) -> Recording:
    """A Recording, with the sound of the system's microphone when asked, and without where there is none.

    Raises OutputError and UsageError like ``Recording``.
    """
    if not microphone:
        return Recording(path, size, rate, transparent)
    try:
        sound = Microphone()
    except OutputError as error:
        return Recording(path, size, rate, transparent, note=f"without sound: {error}")
    return Recording(path, size, rate, transparent, sound)


def recording_in(folder: Path, size: Size, rate: int, transparent: bool = False, microphone: bool = False) -> Recording:
    """A Recording that begins now, under a name of its own in ``folder``, whatever other windows record meanwhile.

    Raises OutputError and UsageError like ``Recording``.
    """
    while True:
        path = recording_name(folder, transparent, datetime.now())
        try:
            return open_recording(path, size, rate, transparent, microphone)
        except TakenError:  # by another window, a moment ago: the next name is free
            continue


def recording_name(folder: Path, transparent: bool, now: datetime) -> Path:
    """A name for a recording that begins now, which neither a finished one has nor one that was cut short."""
    suffix = ".mov" if transparent else ".mp4"
    stem = f"gemheads-{now:%Y-%m-%d-%H%M%S}"
    names = [stem, *(f"{stem}-{number}" for number in range(2, 1000))]
    for name in names:
        path = folder / f"{name}{suffix}"
        if not path.exists() and not (folder / f"{name}.partial{suffix}").exists():
            return path
    raise OutputError(f"{folder}: too many recordings of this second; choose another folder")
