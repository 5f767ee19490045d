"""Reenactment: drivers in, one acting avatar out for each."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from ...models.driver.face import FaceTracker
from ...render.engines import open_engine
from ..credentials.origin import origin_of
from ..credentials.signing import open_signer
from ..errors import (
    NO_ROOM,
    CommandError,
    ExitCode,
    InputError,
    OutputError,
    UsageError,
    brief,
    lacks_room,
    no_way_to,
)
from ..files.crop import WHOLE
from ..files.outputs import is_video, keep_inputs, keep_strangers, plan_outputs
from ..files.places import check_places
from ..files.resuming import made_of_the_same
from ..files.sinks import is_whole, video_codec
from ..files.sources import files_of
from ..performing.casting import check_components, check_track, expression_of, open_avatar
from ..performing.tracks import head_still, load_track
from ..person.neutrals import AUTO, NeutralRule
from ..progress import ProgressBar
from .onedriver import Cast, OneDriver, ingredients, papers_of
from .reports import Outcome, write_report
from .wish import Wish


def reenact(drivers: list[str], out: str, wish: Wish, report: Path | None = None, quiet: bool = False) -> ExitCode:
    """Play every driver into its result and say how it went; one failure does not stop the others.

    Returns OK, INTERRUPTED, or the exit code of the first driver that failed; what nobody foresaw in that one is raised
    when all are done and reported. Raises CommandError for what concerns them all: the avatar, the track, the names of
    the results.
    """
    started = time.perf_counter()
    if not drivers and wish.track is None:
        raise UsageError("no driver given; name a video, a folder of pictures, or --track FILE")
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
    if len(jobs) > 1:
        keep_strangers([*sheets, *(result for _, result in jobs if not wish.resume)])
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
                    outcomes += [Outcome(other, str(left), "not begun") for other, left in jobs[len(outcomes) :]]
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
    if wish.driving != Wish.driving:
        raise UsageError(f"--driver {wish.driving}: a track says what is done; give it to `gemheads track`")
    if wish.side_by_side and not drivers:
        raise UsageError("--side-by-side: a track has no picture of who drove it; name the video, too")
    if wish.crop != WHOLE and not wish.side_by_side:
        raise UsageError("--crop: a track looks at no face; give it to `gemheads track`, or add --side-by-side")


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
    return Cast(avatar, tracker, open_engine(wish.engine), track, signer, trouble)


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
            return replace(outcome, status="kept", message=message, credentials=credentials or cast.unsigned), None
        bar.say(message)
    run = OneDriver(cast, wish, result, bar, started)
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
        elif said := no_way_to(error):
            message = said
            failure = InputError(message)
    return (
        replace(
            outcome,
            status=status,
            tally=run.tally,
            message=message,
            credentials=run.credentials or (cast.unsigned if status == "done" else ""),
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
        same = made_of_the_same(result, ingredients(driver, cast, wish))
    except OSError:  # of a driver that is gone nothing can be made anew
        return True, f"{result}: already done", ""
    if same is None:
        return True, f"{result}: is there already, and nothing in it says what it was made of; passed by", ""
    if not same:
        return False, f"{result}: is of another driver, avatar or settings; made anew", ""
    if not is_video(result):
        return True, f"{result}: already done", ""
    return True, f"{result}: already done", papers_of(cast, wish, driver).sign_once(result)


def _settings(wish: Wish, cast: Cast) -> dict[str, Any]:
    return {
        "avatar": {"file": str(wish.avatar), **origin_of(cast.avatar).as_json()},
        "components": wish.components or cast.avatar.gem.components,
        "size": f"{wish.size[0]}x{wish.size[1]}",
        "driving": "track" if wish.track else wish.driving,
        "crop": str(wish.crop),
        "badge": wish.no_badge or "drawn",
        "engine": {"asked": wish.engine, "used": cast.engine.name, "description": cast.engine.description},
    }
