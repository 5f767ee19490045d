"""``gemheads refine``: the bases of an avatar, changed until its pictures are those of a capture."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from ...models.captures.layout import CaptureError
from ...models.captures.reader import Capture
from ...models.gem import Gem
from ...models.gemfile import GemFormatError, save_gem
from ...models.wholefile import file_sha256
from ..errors import ExitCode, InputError, TrainingExtra, UsageError
from ..files.pictures import write_png
from ..files.places import check_places, place_of_changed, save_learned
from ..performing.casting import Avatar, open_avatar
from ..performing.performance import Pose
from ..progress import ProgressBar
from .likeness import tell_of_unlikeness
from .moments import save_moments
from .opencapture import opened
from .trainingmoments import training_moments

if TYPE_CHECKING:
    from ...models.train.perceptual import Perceptual
    from ...models.train.synthesis.fit import Start
    from ...models.train.synthesis.refine import Refinement

LEAST, MOST = 10, 10_000_000


@dataclass(frozen=True)
class RefineWish:
    """What the command line asks for."""

    iterations: int = 3000
    coefficients: Literal["free", "fixed"] = "free"
    colors: Literal["free", "fixed"] = "free"
    start: Path | None = None
    """A track with the training moments; None projects the bare mesh, or else fits."""
    moments: Path | None = None
    """Where they go as they are after."""
    sheet: Path | None = None
    perceptual: bool = True
    seed: int = 0


def run_refining(avatar: Path, capture: Path, out: Path | None, wish: RefineWish) -> ExitCode:
    """Refine, save the better avatar, and say what came of it. Raises CommandError.

    Stopped with Ctrl-C, it saves the best so far and returns INTERRUPTED. Killed, the same goes on where it was.
    """
    with TrainingExtra("refining"):
        from ...models.train.avatars.train_avatar import default_device
        from ...models.train.synthesis.refine import RefineEffort, refine
        from ...models.train.synthesis.unfinished import Unfinished
    if not LEAST <= wish.iterations <= MOST:
        raise UsageError(f"--iterations {wish.iterations}: choose from {LEAST} to {MOST}")
    over_itself, out = out is None, place_of_changed(avatar, out)
    cast = open_avatar(avatar)
    if over_itself and cast.gem.regressor is not None:
        raise UsageError(f"{avatar}: has a regressor, which knows the old bases and would be lost; give -o OUT.gem")
    footage = opened(capture)
    read = [capture, wish.start, None if out.resolve() == avatar.resolve() else avatar]
    check_places(out, wish.moments, wish.sheet, read=read)
    effort = RefineEffort(
        wish.iterations, coefficients=wish.coefficients == "free", colors=wish.colors == "free", seed=wish.seed
    )
    network = _perceptual() if wish.perceptual else None
    try:
        with ProgressBar() as bar:
            begin = training_moments(cast, footage, wish.start, bar)
            unfinished = Unfinished(out.with_name(f".{out.name}.unfinished"), _identity(cast, footage, begin, wish))
            answer = refine(cast.gem, footage, begin, effort, network, bar.reach, default_device(), unfinished)
    except (CaptureError, FloatingPointError) as error:
        raise InputError(str(error)) from error
    except ValueError as error:
        raise InputError(f"{avatar}: cannot be refined on {capture}: {error}") from error
    _save(answer, cast, footage, out)
    unfinished.remove()
    if wish.moments is not None:
        poses = {time: Pose(m.coefficients, m.pose.turn, translation=m.pose.move) for time, m in answer.moments.items()}
        save_moments(answer.gem.name, file_sha256(out), poses, wish.moments)
    if wish.sheet is not None:
        from .refinesheet import refine_sheet

        sheet = refine_sheet(footage, answer.judges, (cast.gem, begin), (answer.gem, answer.moments))
        write_png(sheet, wish.sheet)
    print(_told(answer, cast, out))
    tell_of_unlikeness(avatar, capture, answer.after)
    return ExitCode.INTERRUPTED if answer.stopped else ExitCode.OK


def _perceptual() -> "Perceptual":
    from ...models.train.avatars.train_avatar import default_device
    from ...models.train.perceptual import Perceptual, WeightsMissing

    try:
        return Perceptual("vgg", default_device())
    except WeightsMissing as error:
        raise InputError(f"{error}; --no-perceptual refines without the VGG term") from error


def _identity(cast: Avatar, footage: Capture, begin: "Mapping[int, Start]", wish: RefineWish) -> str:
    """Tells apart whatever would be refined into something else."""
    effort = wish.iterations, wish.coefficients, wish.colors, wish.perceptual, wish.seed
    known = hashlib.sha256(f"{cast.sha256} {effort}".encode() + footage.template.digest())
    for shot in (*footage.train, *footage.val):
        known.update(f"{shot.camera} {footage.ground(shot)}".encode())
        for file in (shot.picture, shot.mask):
            if file is not None:
                looked = file.stat()
                known.update(f"{file.name} {looked.st_size} {looked.st_mtime_ns}".encode())
    for timestep, moment in sorted(begin.items()):
        known.update(f"{timestep} {moment.pose}".encode() + moment.coefficients.tobytes())
    return known.hexdigest()


def _save(answer: "Refinement", cast: Avatar, footage: Capture, out: Path) -> None:
    """The better avatar; nothing is written where that is the one that is there."""
    if not answer.improved and out.exists() and out.samefile(cast.path):
        return
    try:
        save_learned(partial(save_gem, _signed(answer, footage) if answer.improved else cast.gem), out)
    except GemFormatError as error:
        raise InputError(f"{cast.path}: gives no sound avatar: {error.what}; {error.cure}") from error


def _signed(answer: "Refinement", footage: Capture) -> Gem:
    """The avatar, saying how it came to be."""
    before = answer.gem.about.get("source", "")
    source = f"refined on {footage.folder.name}, {answer.iterations} steps{'; ' if before else ''}{before}"
    return replace(answer.gem, about={**answer.gem.about, "source": source})


def _told(answer: "Refinement", cast: Avatar, out: Path) -> str:
    judges = answer.judged_by
    steps = f"{answer.iterations} steps" + (", stopped" if answer.stopped else "")
    if not answer.improved:
        best = max((quality for done, quality in answer.curve if done), default=answer.before)
        return f"{out}: stays as it was: {answer.before:.2f} dB on {judges}, {best:.2f} dB at best after {steps}"
    lines = [f"{out}: {answer.before:.2f} -> {answer.after:.2f} dB on {judges}, {steps}"]
    if cast.gem.regressor is not None:
        lines.append(f"its regressor knew the old bases and is left out; train one: gemheads train-regressor {out}")
    return "\n".join(lines)
