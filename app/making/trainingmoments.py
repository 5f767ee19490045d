"""What an avatar does at each training moment of a capture: what refining begins at, and what a regressor learns."""

from pathlib import Path
from typing import TYPE_CHECKING

from ...models.captures.reader import Capture
from ...models.importers.baremesh import bare_moments
from ..performing.casting import Avatar
from ..progress import ProgressBar
from .moments import load_moments
from .opencapture import chosen

if TYPE_CHECKING:
    from ...models.train.synthesis.fit import Start


def training_moments(cast: Avatar, footage: Capture, track: Path | None, bar: ProgressBar) -> "dict[int, Start]":
    """Timestep -> expression and pose: of a track; else what was tracked, where the avatar is the capture's bare mesh;
    else fitted, which takes a while.

    Raises InputError for another avatar's track, CaptureError where the capture changed since it was opened.
    """
    from ...models.train.synthesis.fit import HeadPose, Start
    from ...models.train.synthesis.fitcapture import fit_moments

    if track is not None:
        known = load_moments(track, cast)
        return {time: Start(pose.coefficients, HeadPose(pose.turn, pose.translation)) for time, pose in known.items()}
    bare = bare_moments(footage, cast.gem)
    if bare is not None:
        bar.say(f"{cast.path}: is the bare mesh of {footage.folder}: it begins at what was tracked")
        found = {}
        for time, coefficients in bare.items():
            tracked = footage.tracked(time)
            found[time] = Start(coefficients, HeadPose(tracked.rotation, tracked.translation))
        return found
    total = len(footage.timesteps("train"))
    bar.say(f"{cast.path}: its {total} moments are fitted first; a track of `distill --moments` spares that")
    found = {}
    for moment in fit_moments(cast.gem, footage, chosen(footage, "train", None)):
        found[moment.timestep] = Start(moment.fit.coefficients, moment.fit.pose)
        bar.reach("fit", len(found), total)
    return found
