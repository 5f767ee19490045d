"""One driver into one result."""

import hashlib
import time
from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path
from typing import Any

from ...models.driver.face import FaceTracker
from ...models.wholefile import file_sha256
from ...render.arrays import Image
from ...render.engines import Engine
from ..credentials.badge import badged
from ..credentials.origin import origin_of
from ..credentials.papers import Papers, driver_of
from ..credentials.signing import Signer
from ..credentials.statement import Statement
from ..errors import InputError, NoFaceError
from ..files.claim import claimed_folder
from ..files.frames import Frame
from ..files.leftovers import take_over
from ..files.outputs import is_video
from ..files.recipes import recipe_of
from ..files.sinks import TIMES_FILE, FolderSink, Sink, VideoSink
from ..files.sources import Source, files_of, files_sha256, open_source
from ..files.video import VideoFile
from ..live import Stage, perform, run_offline
from ..performing.casting import Avatar, expression_of
from ..performing.performance import Pose
from ..performing.portrait import portrait
from ..performing.presence import Phase
from ..performing.threads import ahead
from ..performing.timing import Stopwatch
from ..performing.tracks import Track
from ..person.following import Actor
from ..person.neutrals import find_neutral, said
from ..progress import ProgressBar
from .beside import beside_width, side_by_side
from .reports import Tally
from .wish import Wish

_Shot = tuple[Frame | None, Pose, int]
"""A frame of the driver, what the avatar does, and when (PTS)."""


@dataclass(frozen=True)
class Cast:
    """What is opened once for all drivers."""

    avatar: Avatar
    tracker: FaceTracker | None
    engine: Engine
    track: Track | None
    signer: Signer | None
    """None where the extra that signs is not installed, or its key cannot be used."""
    unsigned: str = ""
    """Why results carry no credentials, where that is not the missing extra."""


class OneDriver:
    """One driver into one result."""

    def __init__(self, cast: Cast, wish: Wish, result: Path, bar: ProgressBar, started: float) -> None:
        self._cast, self._wish, self._result, self._bar, self._started = cast, wish, result, bar, started
        self.tally = Tally()
        self.watch = Stopwatch()
        self.neutral: dict[str, Any] = {}
        self._neutral_sha256 = ""
        self.credentials = ""
        self.first_frame_secs = self.seconds = 0.0
        self.left: Path | None = None
        """The unfinished result, where one was begun."""

    @property
    def rate(self) -> float:
        """Frames per second, from the first to the last."""
        return self.tally.frames / max(1e-9, self.seconds - self.first_frame_secs)

    def play(self, driver: str | None) -> None:
        """Everything from opening the driver to the finished file. Raises CommandError, KeyboardInterrupt."""
        cast, wish = self._cast, self._wish
        source = open_source(driver, wish.rate, crop=wish.crop) if driver else None
        performance = self._performance(source)
        self._bar.say_once(origin_of(cast.avatar).said())
        gem = cast.avatar.gem
        stage = Stage(gem, cast.engine, portrait(gem.viewing, *wish.size), wish.background, self.watch, wish.components)
        extra = beside_width(source.size, wish.size[1]) if source and wish.side_by_side else 0
        papers = papers_of(cast, wish, driver)
        try:
            with nullcontext() if is_video(self._result) else claimed_folder(self._result):
                self._draw(performance, stage, source, papers, extra)
            self.credentials = papers.sign(self._result) if is_video(self._result) else papers.said
        finally:
            self.seconds = time.perf_counter() - self._started

    def _draw(
        self, performance: Iterable[_Shot], stage: Stage, source: Source | None, papers: Papers, extra: int
    ) -> None:
        """The pictures; ``extra`` columns of them show the driver."""
        wish = self._wish
        timing = self._cast.track or source
        assert timing is not None
        width, height = wish.size
        sink = self._sink((width + extra, height), timing.time_base, timing.rate, source, papers)
        self.left = sink.partial
        self._bar.begin(self._result.name, timing.frame_count)

        def finish(picture: Image, frame: Frame | None) -> Image:
            picture = side_by_side(frame.rgb, picture, extra) if extra and frame else picture
            return picture if wish.no_badge else badged(picture)

        run_offline(performance, stage, finish, sink, self._tell)
        if source is not None and self._cast.track is None and self.tally.remark:
            self._bar.say(f"{source.path}: {self.tally.remark}")
        if isinstance(source, VideoFile) and source.left_out:
            self._bar.say(
                f"{source.path}: {source.left_out} pictures were left out whose times do not rise; if that is much"
                " of it, convert it to mp4"
            )

    def _performance(self, source: Source | None) -> Iterable[_Shot]:
        if self._cast.track is not None:
            return iter(self._cast.track) if source is None else self._beside(self._cast.track, source)
        assert source is not None
        assert self._cast.tracker is not None
        with self.watch("neutral"):
            neutral = find_neutral(self._wish.neutral, source, self._cast.tracker)
        self._bar.say(f"{source.path}: neutral: {said(neutral, self._wish.neutral)}")
        self._neutral_sha256 = hashlib.sha256(neutral.features.tobytes() + neutral.rotation.tobytes()).hexdigest()
        self.neutral = {
            "rule": self._wish.neutral.kind,
            "seconds": round(neutral.time, 3),
            "why": neutral.reason,
            "others_seconds": [round(candidate.time, 3) for candidate in neutral.candidates[1:]],
        }
        avatar = self._cast.avatar
        actor = Actor(
            tracker=self._cast.tracker,
            neutral=neutral,
            express=expression_of(avatar, self._wish.driving),
            gem=avatar.gem,
            lids=avatar.lids,
            head_pose=self._wish.head_pose,
        )
        return self._with_a_face(perform(actor, ahead(source.frames()), self.watch), source)

    def _beside(self, track: Track, source: Source) -> Iterator[_Shot]:
        """A track with a driver, of which is told when it is another file: times alone do not tell two videos apart,
        and what was only given another sound may be meant."""
        if track.driver_sha256 not in ("", driver_of(str(source.path), None).sha256):
            self._bar.say(
                f"{source.path}: is not the file that {self._wish.track} was made of; if it does not show the same,"
                " give the one that was tracked, or track this one"
            )
        return _paired(track, source)

    def _with_a_face(self, performance: Iterable[_Shot], source: Source) -> Iterator[_Shot]:
        """A performance in which somebody is followed. Raises NoFaceError at its end where nobody was: then what was
        drawn is no result, and keeps the name of an unfinished one."""
        seen = False
        for shot in performance:
            seen = seen or shot[1].phase is Phase.TRACKING
            yield shot
        if not seen:
            raise NoFaceError(f"{source.path}: no face in any frame; {self.left} shows the avatar at rest")

    def _sink(
        self, size: tuple[int, int], time_base: Fraction, rate: Fraction, source: Source | None, papers: Papers
    ) -> Sink:
        transparent = self._wish.background is None
        if not is_video(self._result):
            made_of = self._made_of(source)
            kept, why_not = take_over(self._result, ".png", made_of, self._wish.resume, [TIMES_FILE])
            if why_not:
                self._bar.say(why_not)
            return FolderSink(self._result, time_base, kept, papers.signed_png)
        audio = source.path if isinstance(source, VideoFile) and source.has_audio else None
        if isinstance(source, VideoFile) and source.has_unreadable_audio:
            self._bar.say(f"{source.path}: its sound is of a kind that cannot be read here; the result has none")
        recipe = recipe_of(ingredients(None if source is None else str(source.path), self._cast, self._wish))
        return VideoSink(self._result, size, time_base, rate, transparent, audio, recipe)

    def _made_of(self, source: Source | None) -> dict[str, str]:
        """Everything that decides what the pictures show."""
        driver = None if source is None else str(source.path)
        return {**ingredients(driver, self._cast, self._wish), "neutral": self._neutral_sha256}

    def _tell(self, index: int, pose: Pose, frame: Frame | None) -> None:
        if index == 0:
            self.first_frame_secs = time.perf_counter() - self._started
        self.tally.add(pose) if frame is None else self.tally.add(pose, frame.luma)
        self._bar.advance()


def ingredients(driver: str | None, cast: Cast, wish: Wish) -> dict[str, str]:
    """Everything that decides what a result shows, but for the neutral that is found; engines draw alike. Raises
    OSError where the driver cannot be read."""
    return {
        "avatar": cast.avatar.sha256,
        "driver": files_sha256(files_of(driver)) if driver else "",
        "track": file_sha256(wish.track) if wish.track else "",
        "rule": wish.neutral.settled(),
        **wish.settings(),
    }


def papers_of(cast: Cast, wish: Wish, driver: str | None) -> Papers:
    """What is signed into a result."""
    if cast.signer is None:
        return Papers(None, Statement((), driver_of(None, None)))
    told = driver_of(driver, wish.track, wish.name_driver)
    along = driver_of(driver, None, wish.name_driver) if driver and wish.track else None
    beside = wish.side_by_side and driver is not None
    return Papers(cast.signer, Statement((origin_of(cast.avatar),), told, wish.no_badge, beside, along))


def _paired(track: Track, source: Source) -> Iterator[tuple[Frame, Pose, int]]:
    """A track with the frames it was made from, for their sound and for side by side."""
    cure = "give the video that was tracked, or track this one"
    for shot, frame in zip_longest(track, ahead(source.frames())):
        if shot is None or frame is None:
            what = "goes on after" if shot is None else "ends before"
            raise InputError(f"{source.path}: {what} the {track.frame_count} frames of the track; {cure}")
        _, pose, pts = shot
        if frame.pts * source.time_base != pts * track.time_base:
            raise InputError(f"{source.path}: its times are not those of the track; {cure}")
        yield frame, pose, pts
