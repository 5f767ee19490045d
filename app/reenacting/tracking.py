"""A driver into a coefficient track: everything of reenactment but the drawing."""

from fractions import Fraction
from pathlib import Path

import numpy as np

from ...models.driver.face import FaceTracker
from ..credentials.papers import driver_of
from ..errors import ExitCode, NoFaceError
from ..files.crop import WHOLE, Crop
from ..files.outputs import keep_inputs
from ..files.places import check_places
from ..files.sinks import partial_name
from ..files.sources import files_of, open_source
from ..live import perform
from ..performing.casting import Driving, expression_of, open_avatar
from ..performing.performance import Pose
from ..performing.threads import ahead
from ..performing.timing import Stopwatch
from ..performing.tracks import Track, save_track
from ..person.following import Actor
from ..person.neutrals import NeutralRule, find_neutral, said
from ..progress import ProgressBar
from .reports import Tally


def run_tracking(
    driver: str,
    out: Path,
    avatar: Path,
    rule: NeutralRule,
    driving: Driving,
    rate: Fraction = Fraction(30),
    crop: Crop = WHOLE,
) -> ExitCode:
    """Follow the face of ``driver`` (in that part of its pictures) and save what the avatar would do. Raises
    CommandError.

    Stopped with Ctrl-C, it keeps the track up to there under the name of an unfinished one, so that an older one stays
    as it is, and returns INTERRUPTED.
    """
    source = open_source(driver, rate, crop=crop)
    keep_inputs([out, rule.sheet], [*files_of(driver), rule.picture, avatar])
    cast = open_avatar(avatar)
    check_places(out)
    tracker = FaceTracker()
    express = expression_of(cast, driving)
    neutral = find_neutral(rule, source, tracker)
    actor = Actor(tracker, neutral, express, cast.gem, cast.lids)
    poses: list[Pose] = []
    times: list[int] = []
    tally, code = Tally(), ExitCode.OK
    with ProgressBar() as bar:
        bar.say(f"neutral: {said(neutral, rule)}")
        bar.begin(out.name, source.frame_count)
        try:
            for frame, pose, pts in perform(actor, ahead(source.frames()), Stopwatch()):
                poses.append(pose)
                times.append(pts)
                tally.add(pose, frame.luma)
                bar.advance()
        except KeyboardInterrupt:
            code = ExitCode.INTERRUPTED
        if not tally.frames:
            bar.say(f"{out}: stopped before the first frame; nothing was written")
            return code
        if tally.without_face == tally.frames:
            raise NoFaceError(f"{driver}: no face in any frame, so there is nothing to keep; check the clip")
        track = Track(
            avatar=cast.gem.name,
            avatar_sha256=cast.sha256,
            time_base=source.time_base,
            rate=source.rate,
            pts=np.array(times, np.int64),
            poses=tuple(poses),
            driver_sha256=driver_of(driver, None).sha256,
        )
        kept = partial_name(out) if code else out
        save_track(track, kept)
        stopped = "stopped after " if code else ""
        bar.say(f"{kept}: {stopped}{tally.frames} frames, {tally.without_face} of them without a face")
        if tally.remark:
            bar.say(f"{driver}: {tally.remark}")
    return code
