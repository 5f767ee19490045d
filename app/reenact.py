"""Reenactment: drivers in, one acting avatar out for each."""

import hashlib
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from itertools import zip_longest
from pathlib import Path
from typing import Any, Literal

from ..models.driver.face import FaceTracker
from ..models.wholefile import file_sha256
from ..render.engines import Engine, open_engine
from .badge import badged
from .beside import beside_width, side_by_side
from .casting import Avatar, Driving, check_components, check_track, expression_of, open_avatar
from .credentials.papers import Papers, driver_of
from .credentials.signing import Signer, open_signer
from .credentials.statement import Statement
from .errors import (
    NO_ROOM,
    CommandError,
    ExitCode,
    InputError,
    NoFaceError,
    OutputError,
    UsageError,
    brief,
    lacks_room,
)
from .following import Actor
from .frames import Frame
from .leftovers import take_over
from .live import Image, Stage, perform, run_offline
from .neutrals import AUTO, NeutralRule, find_neutral, said
from .origin import origin_of
from .outputs import is_video, keep_inputs, plan_outputs
from .performance import Pose
from .places import check_places
from .portrait import portrait
from .progress import ProgressBar
from .recipes import recipe_of
from .reports import Outcome, Tally, write_report
from .resuming import made_of_the_same
from .sinks import TIMES_FILE, FolderSink, Sink, VideoSink, is_whole, video_codec
from .sources import Source, files_of, open_source
from .threads import ahead
from .timing import Stopwatch
from .tracks import Track, head_still, load_track
from .video import VideoFile


@dataclass(frozen=True)
class Wish:
    """What the command line asks for; the same for every driver."""

    avatar: Path
    components: int | None = None
    size: tuple[int, int] = (512, 512)
    neutral: NeutralRule = AUTO
    side_by_side: bool = False
    background: tuple[float, float, float] | None = (0.75, 0.75, 0.75)
    head_pose: bool = True
    resume: bool = False
    engine: Literal["auto", "quads", "software"] = "auto"
    driving: Driving = "learned"
    rate: Fraction = Fraction(30)
    """Frames per second of drivers that are pictures."""
    track: Path | None = None
    """Play this performance instead of following a face."""
    no_badge: str = ""
    """Why the SYNTHETIC badge is left out; empty draws it."""
    name_driver: bool = False
    """Whether the driver's file name goes into the credentials."""

    def settings(self) -> dict[str, str]:
        """What decides how results look, beside the files that are named and the neutral that is found."""
        others = {"avatar", "track", "neutral", "resume", "engine"}
        names = [part.name for part in fields(self) if part.name not in others]
        return {name.replace("_", " "): str(getattr(self, name)) for name in names}


@dataclass(frozen=True)
class Cast:
    """What is opened once for all drivers."""

    avatar: Avatar
    tracker: FaceTracker | None
    engine: Engine
    track: Track | None
    signer: Signer | None
    """None where the extra that signs is not installed, or its key cannot be used."""


def reenact(drivers: list[str], out: str, wish: Wish, report: Path | None = None, quiet: bool = False) -> ExitCode:
    """Play every driver into its result and say how it went; one failure does not stop the others.

    Returns OK, INTERRUPTED, or the exit code of the first driver that failed; what nobody foresaw in that one is raised
    when all are done and reported. Raises CommandError for what concerns them all: the avatar, the track, the names of
    the results.
    """
    started = time.perf_counter()
    if not drivers and wish.track is None:
        raise UsageError("no driver given; name a video, a folder of pictures, or --track FILE")
    if "" in drivers:
        raise UsageError("a driver without a name; name a video or a folder of pictures")
    _check_beside_track(drivers, wish)
    jobs = plan_outputs(drivers or [str(wish.track)], out, wish.background is None)
    for _, result in jobs:
        if is_video(result):
            video_codec(result.suffix.lower(), wish.background is None)
    sheets = [_with_sheet(wish.neutral, result, len(jobs)).sheet for _, result in jobs]
    keep_inputs(
        [*(result for _, result in jobs), *sheets, report],
        [*(file for driver in drivers for file in files_of(driver)), wish.neutral.picture, wish.avatar, wish.track],
    )
    check_places(report, *sheets)
    outcomes: list[Outcome] = []
    failure: BaseException | None = None
    with ProgressBar(quiet) as bar:
        cast = _opened(wish, bool(drivers), bar)
        try:
            for driver, result in jobs:
                own = replace(wish, neutral=_with_sheet(wish.neutral, result, len(jobs)))
                outcome, error = _outcome_of(driver if drivers else None, result, cast, own, bar, started)
                outcomes.append(outcome)
                bar.say(f"error: {outcome.message}" if outcome.status == "failed" else outcome.message)
                failure = failure or error
                started = time.perf_counter()
                if isinstance(error, KeyboardInterrupt):
                    failure = error
                    break
        finally:
            cast.engine.close()
    if report:
        write_report(report, _settings(wish, cast), outcomes)
    if failure is None:
        return ExitCode.OK
    if isinstance(failure, KeyboardInterrupt):
        return ExitCode.INTERRUPTED
    if isinstance(failure, CommandError):
        return failure.code
    raise failure


def _check_beside_track(drivers: list[str], wish: Wish) -> None:
    """Raises UsageError for what does nothing where a track says what is done."""
    if wish.track is None:
        return
    if wish.neutral.sheet is not None or wish.neutral.kind != AUTO.kind:
        option = "--neutral" if wish.neutral.sheet is None else "--neutral-sheet"
        raise UsageError(f"{option}: a track needs no neutral; give it to `gemheads track`, or leave out --track")
    if wish.side_by_side and not drivers:
        raise UsageError("--side-by-side: a track has no picture of who drove it; name the video, too")


def _opened(wish: Wish, followed: bool, bar: ProgressBar) -> Cast:
    avatar = open_avatar(wish.avatar)
    check_components(avatar, wish.components)
    track = load_track(wish.track) if wish.track else None
    if track and wish.track:
        check_track(avatar, track, wish.track)
        track = track if wish.head_pose else head_still(track)
    else:
        expression_of(avatar, wish.driving)  # fails now rather than after the tracker and the engine have started
    tracker = FaceTracker() if followed and track is None else None
    signer, trouble = open_signer()
    if trouble:
        bar.say_once(trouble)
    return Cast(avatar, tracker, open_engine(wish.engine), track, signer)


def _with_sheet(rule: NeutralRule, result: Path, drivers: int) -> NeutralRule:
    """With several drivers the contact sheets go to a folder, each named like its result."""
    if rule.sheet is None or drivers == 1:
        return rule
    return replace(rule, sheet=rule.sheet / f"{result.stem if is_video(result) else result.name}.png")


def _outcome_of(
    driver: str | None, result: Path, cast: Cast, wish: Wish, bar: ProgressBar, started: float
) -> tuple[Outcome, BaseException | None]:
    """One driver's run, whatever happens in it, and what ended it early."""
    outcome = Outcome(driver or str(wish.track), str(result), "failed")
    if wish.resume and is_whole(result):
        kept, message, credentials = _passed_by(driver, result, cast, wish)
        if kept:
            return replace(outcome, status="kept", message=message, credentials=credentials), None
        bar.say(message)
    run = _Run(cast, wish, result, bar, started)
    status, failure = "failed", None
    try:
        run.play(driver)
        status = "done"
        message = f"{result}: {run.tally.frames} frames in {run.seconds:.1f} s ({run.rate:.0f} frames/s)"
        message += f", {run.credentials}" if run.credentials else ""
    except KeyboardInterrupt as error:
        status, failure = "interrupted", error
        message = f"{result}: stopped before the first frame; nothing was written"
        if run.tally.frames:
            message = f"{run.left}: stopped after {run.tally.frames} frames; what is there can be played"
    except CommandError as error:
        message, failure = str(error), error
    except Exception as error:  # whatever a file of somebody's does, the other drivers have their turn
        message, failure = f"{outcome.driver}: unexpected {type(error).__name__}: {brief(error)}", error
        if lacks_room(error):
            message = f"{outcome.driver}: {NO_ROOM}"
            failure = OutputError(message)
    return (
        replace(
            outcome,
            status=status,
            tally=run.tally,
            message=message,
            credentials=run.credentials,
            neutral=run.neutral,
            stages_ms=run.watch.mean_ms(),
            seconds=round(run.seconds, 3),
            first_frame_seconds=round(run.first_frame_secs, 3),
        ),
        failure,
    )


def _passed_by(driver: str | None, result: Path, cast: Cast, wish: Wish) -> tuple[bool, str, str]:
    """Whether a result that is whole is left as it is, a sentence about it, and what is said of its credentials.

    What this run would make is signed where it was not; nothing is signed of which that is not known.
    """
    try:
        same = made_of_the_same(result, _ingredients(driver, cast, wish))
    except OSError:  # of a driver that is gone nothing can be made anew
        return True, f"{result}: already done", ""
    if same is None:
        return True, f"{result}: is there already, and nothing in it says what it was made of; passed by", ""
    if not same:
        return False, f"{result}: is of another driver, avatar or settings; made anew", ""
    if not is_video(result):
        return True, f"{result}: already done", ""
    return True, f"{result}: already done", _papers(cast, wish, driver).sign_once(result)


def _ingredients(driver: str | None, cast: Cast, wish: Wish) -> dict[str, str]:
    """Everything that decides what a result shows, but for the neutral that is found; engines draw alike. Raises
    OSError where the driver cannot be read."""
    return {
        "avatar": cast.avatar.sha256,
        "driver": _sha256(files_of(driver)) if driver else "",
        "track": file_sha256(wish.track) if wish.track else "",
        "rule": f"{wish.neutral.kind} {wish.neutral.value}",
        **wish.settings(),
    }


class _Run:
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
        source = open_source(driver, wish.rate) if driver else None
        performance = self._performance(source)
        self._bar.say_once(origin_of(cast.avatar).said())
        timing = cast.track or source
        assert timing is not None
        width, height = wish.size
        extra = beside_width(source.size, height) if source and wish.side_by_side else 0
        gem = cast.avatar.gem
        stage = Stage(gem, cast.engine, portrait(gem.viewing, *wish.size), wish.background, self.watch, wish.components)
        papers = _papers(cast, wish, driver, beside=extra > 0)
        sink = self._sink((width + extra, height), timing.time_base, timing.rate, source, papers)
        self.left = sink.partial
        self._bar.begin(self._result.name, timing.frame_count)

        def finish(picture: Image, frame: Frame | None) -> Image:
            picture = side_by_side(frame.rgb, picture, extra) if extra and frame else picture
            return picture if wish.no_badge else badged(picture)

        try:
            run_offline(performance, stage, finish, sink, self._tell)
            if isinstance(source, VideoFile) and source.left_out:
                self._bar.say(
                    f"{source.path}: {source.left_out} pictures were left out whose times do not rise; if that is much"
                    " of it, convert it to mp4"
                )
            self.credentials = papers.sign(self._result) if is_video(self._result) else papers.said
        finally:
            self.seconds = time.perf_counter() - self._started
        if cast.track is None and self.tally.without_face == self.tally.frames:
            raise NoFaceError(f"{driver}: no face in any frame; {self._result} shows the avatar at rest")

    def _performance(self, source: Source | None) -> Iterable[tuple[Frame | None, Pose, int]]:
        if self._cast.track is not None:
            return iter(self._cast.track) if source is None else _paired(self._cast.track, source)
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
        return perform(actor, ahead(source.frames()), self.watch)

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
        recipe = recipe_of(_ingredients(None if source is None else str(source.path), self._cast, self._wish))
        return VideoSink(self._result, size, time_base, rate, transparent, audio, recipe)

    def _made_of(self, source: Source | None) -> dict[str, str]:
        """Everything that decides what the pictures show."""
        driver = None if source is None else str(source.path)
        return {**_ingredients(driver, self._cast, self._wish), "neutral": self._neutral_sha256}

    def _tell(self, index: int, pose: Pose) -> None:
        if index == 0:
            self.first_frame_secs = time.perf_counter() - self._started
        self.tally.add(pose)
        self._bar.advance()


def _papers(cast: Cast, wish: Wish, driver: str | None, beside: bool = False) -> Papers:
    """What is signed into a result."""
    if cast.signer is None:
        return Papers(None, Statement((), driver_of(None, None)))
    told = driver_of(driver, wish.track, wish.name_driver)
    return Papers(cast.signer, Statement((origin_of(cast.avatar),), told, wish.no_badge, beside))


def _sha256(files: Iterable[Path]) -> str:
    """Of all that is in these files, in their order; folders among them are passed over."""
    return hashlib.sha256("".join(file_sha256(file) for file in files if file.is_file()).encode()).hexdigest()


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


def _settings(wish: Wish, cast: Cast) -> dict[str, Any]:
    return {
        "avatar": {"file": str(wish.avatar), **origin_of(cast.avatar).as_json()},
        "components": wish.components or cast.avatar.gem.components,
        "size": f"{wish.size[0]}x{wish.size[1]}",
        "driving": "track" if wish.track else wish.driving,
        "badge": wish.no_badge or "drawn",
        "engine": {"asked": wish.engine, "used": cast.engine.name, "description": cast.engine.description},
    }
