"""``gemheads train-regressor`` with a capture: learned from the person's own frames, judged on frames held out."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from ...models.captures.layout import CaptureError
from ...models.driver.regressor import Regressor
from ...models.gemfile import load_gem, read_info, save_gem
from ..errors import ExitCode, InputError, NoFaceError, TrainingExtra, UsageError
from ..files.pictures import write_png
from ..files.places import check_places, place_of_changed, save_learned
from ..performing.casting import open_avatar
from ..progress import ProgressBar
from ..reenacting.reports import write_json
from .opencapture import opened
from .training import LEAST_PICTURES, check_learning, check_moves, check_videos, processes
from .trainingmoments import training_moments

if TYPE_CHECKING:
    from ...models.train.regressors.capture_regressor import CaptureRegressor
    from ...models.train.regressors.selfreenact import SelfReenactment


@dataclass(frozen=True)
class OwnWish:
    """What the command line asks for."""

    videos: tuple[Path, ...] = ()
    companions: tuple[Path, ...] = ()
    pictures: int = 2000
    """0: the paper's recipe alone, without the closed loop."""
    steps: int = 6000
    seed: int = 0
    labels: Path | None = None
    """A track with the training moments; None: see ``training_moments``."""
    report: Path | None = None
    strip: Path | None = None
    jobs: int | None = None
    """Processes; None: as many as are worth it."""


def run_own_training(avatar: Path, capture: Path, out: Path | None, wish: OwnWish) -> ExitCode:
    """Train the regressor of a captured person's avatar, save the avatar with it, and say how well it drives itself.

    Raises CommandError.
    """
    with TrainingExtra("training"):
        from ...models.train.regressors.capture_regressor import RegressorEffort, capture_regressor
        from ...models.train.regressors.footage import read_footage
        from ...models.train.regressors.response import AvatarNotSeen
        from ...models.train.regressors.selfreenact import self_reenactment
        from ...models.train.regressors.train_regressor import FEWEST_OF_STRANGERS, pictures_of
        from ...models.train.workers import WorkerLost, Workers
    _check(wish)
    check_moves(avatar, *wish.companions)
    check_videos(wish.videos)
    out = place_of_changed(avatar, out)
    cast, footage = open_avatar(avatar), opened(capture)
    own = None if out.resolve() == avatar.resolve() else avatar
    check_places(out, wish.report, wish.strip, read=[capture, own, wish.labels, *wish.videos, *wish.companions])
    if wish.strip is not None and not footage.test:
        raise UsageError(f"--strip {wish.strip}: {capture} has no held-out expressions (test) to show; leave it out")
    effort = RegressorEffort(wish.pictures, wish.steps, seed=wish.seed)
    try:
        with ProgressBar() as bar, Workers(processes(wish.jobs)) as workers:
            moments = training_moments(cast, footage, wish.labels, bar)
            videos = read_footage(wish.videos, lambda done, total: bar.reach("videos", done, total))
            count = max(FEWEST_OF_STRANGERS, wish.pictures // 4)
            others = [
                pictures_of(load_gem(path), count, wish.seed, partial(bar.reach, "companions"), workers)
                for path in (wish.companions if wish.pictures else ())
            ]
            learned = capture_regressor(cast.gem, footage, moments, effort, others, videos, bar.reach, workers)
            Regressor.of(learned.gem)  # what cannot be opened is not saved
    except AvatarNotSeen as error:
        raise NoFaceError(f"{error}; --pictures 0 learns without the avatar's own pictures") from error
    except (CaptureError, ValueError, WorkerLost) as error:
        raise InputError(str(error)) from error
    save_learned(partial(save_gem, learned.gem, basis=read_info(avatar).card.basis), out)
    judged: SelfReenactment | None = None
    try:
        if footage.test:
            with ProgressBar() as bar:
                judged = self_reenactment(learned.gem, footage, learned.neutral, progress=bar.reach)
    except (CaptureError, ValueError) as error:
        raise InputError(f"{out}: is saved, but how well it follows cannot be judged: {error}") from error
    if wish.report is not None:
        write_json(wish.report, _document(learned, judged))
    if wish.strip is not None and judged is not None:
        write_png(judged.strip, wish.strip)
    print(_told(out, learned, judged))
    return ExitCode.OK


def _check(wish: OwnWish) -> None:
    if wish.pictures and wish.pictures < LEAST_PICTURES:
        raise UsageError(f"--pictures {wish.pictures}: choose {LEAST_PICTURES} or more, or 0 for the frames alone")
    check_learning(wish.steps, wish.jobs)


def _document(learned: "CaptureRegressor", judged: "SelfReenactment | None") -> dict[str, object]:
    """Every figure as plain JSON; decibels, shares and counts."""
    seen = learned.sightings
    figures: dict[str, object] = {
        "avatar": learned.gem.name,
        "cameras": list(learned.cameras),
        "pictures": len(seen),
        "pictures_without_a_face": seen.unseen,
        "response_r2": learned.response_r2,
        "mismatch_before_after": learned.mismatches,
    }
    if judged is not None:
        figures["held_out"] = {
            "psnr": judged.psnr,
            "ssim": judged.ssim,
            "missed_motion": judged.missed,
            "pictures": judged.pictures,
            "pictures_without_a_face": judged.unseen,
        }
    return figures


def _told(out: Path, learned: "CaptureRegressor", judged: "SelfReenactment | None") -> str:
    seen = learned.sightings
    text = f"{out}: regressor trained on {len(seen)} pictures of cameras {', '.join(map(str, learned.cameras))}"
    if seen.unseen:
        text += f" ({seen.unseen} show no face)"
    lines = [text]
    if judged is not None:
        floor, driven, ceiling = (judged.psnr[row] for row in ("rest", "driven", "fitted"))
        lines.append(
            f"driven by its own held-out pictures: {driven:.2f} dB (at rest {floor:.2f}, fitted {ceiling:.2f}), misses"
            f" {judged.missed:.0%} of the motion"
        )
    if learned.mismatches is not None:
        before, after = learned.mismatches
        lines.append(f"mismatch with people: {before:.2f} -> {after:.2f} tolerances")
    return "\n".join(lines)
