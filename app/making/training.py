"""Training from the command line: the one way from here into ``models.train``, and only when it is asked for."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from ...models.driver.regressor import Regressor
from ...models.gem import Gem
from ...models.gemfile import GemFormatError, load_gem, read_info, save_gem
from ..errors import ExitCode, InputError, TrainingExtra, UsageError
from ..files.places import check_places, place_of_changed, save_learned
from ..jobs import affordable_jobs, check_jobs
from ..progress import ProgressBar

MEMORY = 1_500_000_000
"""Bytes that must be free for each process: a network that learns, with what it learns from, takes as much."""
LEAST_PICTURES = 40
"""With fewer, nothing is known of how the avatar answers."""


@dataclass(frozen=True)
class TrainingWish:
    """What a training without a capture is asked for; defaults as in ``models.train.train_regressor``."""

    videos: tuple[Path, ...] = ()
    companions: tuple[Path, ...] = ()
    former: Path | None = None
    pictures: int = 4000
    steps: int = 9000
    seed: int = 0
    jobs: int | None = None
    """Processes; None: as many as are worth it."""
    turns_only: bool = False
    """Whether only how the head turns is learned."""


def run_training(avatar: Path, out: Path | None, wish: TrainingWish) -> ExitCode:
    """Train an avatar file's regressor, or how its head turns, and save the avatar with it. Raises CommandError."""
    with TrainingExtra("training"):
        from ...models.train.regressors.response import AvatarNotSeen
        from ...models.train.workers import WorkerLost
    if wish.pictures < LEAST_PICTURES:
        raise UsageError(f"--pictures {wish.pictures}: choose {LEAST_PICTURES} or more")
    check_learning(wish.steps, wish.jobs)
    check_moves(avatar, *wish.companions)
    check_videos(wish.videos)
    out = _place(avatar, out, [*wish.videos, *wish.companions, wish.former])
    try:
        gem, told = (_turns if wish.turns_only else _regressor)(avatar, wish)
        Regressor.of(gem)  # what cannot be opened is not saved
    # a ValueError is a GemFormatError, a RegressorError, or what is wrong with a video
    except (ValueError, AvatarNotSeen, WorkerLost) as error:
        raise InputError(str(error)) from error
    save_learned(partial(save_gem, gem, basis=read_info(avatar).card.basis), out)
    print(f"{out}: {told}")
    return ExitCode.OK


def _regressor(avatar: Path, wish: TrainingWish) -> tuple[Gem, str]:
    """The avatar with a regressor, and what is said of it."""
    from ...models.train.regressors.train_regressor import train_regressor

    with ProgressBar() as bar:
        gem, report = train_regressor(
            avatar,
            companions=wish.companions,
            videos=wish.videos,
            former=wish.former,
            pictures=wish.pictures,
            steps=wish.steps,
            seed=wish.seed,
            progress=bar.reach,
            jobs=processes(wish.jobs),
        )
    return gem, (
        f"regressor trained on {report.pictures} pictures; the avatar's response is known to"
        f" R2 {report.response_r2:.2f}; mismatch with people {report.start_mismatch:.2f} -> {report.end_mismatch:.2f}"
    )


def _turns(avatar: Path, wish: TrainingWish) -> tuple[Gem, str]:
    """The avatar with what it learned of its turns, and what is said of that."""
    from ...models.train.regressors.train_turns import train_turns

    with ProgressBar() as bar:
        gem, turns = train_turns(
            avatar,
            companions=wish.companions,
            videos=wish.videos,
            pictures=wish.pictures,
            steps=wish.steps,
            seed=wish.seed,
            progress=bar.reach,
            jobs=processes(wish.jobs),
        )
    before, after = (" ".join(f"{angle:.2f}" for angle in angles) for angles in (turns.missed_deg, turns.left_deg))
    return gem, (
        f"turns learned of {turns.portraits} portraits; pitch, yaw and roll are misread by {before} degrees (RMS), of"
        f" which {after} are not known"
    )


def _place(avatar: Path, out: Path | None, read: Sequence[Path | None]) -> Path:
    """Where the avatar is written with what it learned; over itself it may be. Raises CommandError."""
    out = place_of_changed(avatar, out)
    check_places(out, read=read)
    return out


def check_learning(steps: int, jobs: int | None) -> None:
    """Raises UsageError for numbers that cannot be."""
    if steps < 1:
        raise UsageError(f"--steps {steps}: choose 1 or more")
    check_jobs(jobs)


def check_videos(videos: Sequence[Path]) -> None:
    """Raises InputError for one that is not there, or is a folder."""
    for video in videos:
        if video.is_dir():
            raise InputError(f"{video}: is a folder, and no capture; give video files, or the folder of a capture")
        if not video.is_file():
            raise InputError(f"{video}: no such video; check the path")


def check_moves(*avatars: Path) -> None:
    """Raises InputError for an avatar without components: there is nothing that a regressor could answer."""
    for avatar in avatars:
        try:
            layout = read_info(avatar).layout
        except GemFormatError as error:
            raise InputError(str(error)) from error
        if not any(layout.components.values()):
            raise InputError(f"{avatar}: does not move, so no face can drive it; distill it from several frames")


def processes(jobs: int | None) -> int:
    """How many share the work where ``jobs`` are asked for, or none in particular."""
    return affordable_jobs(MEMORY) if jobs is None else jobs


def run_taking_over(avatar: Path, out: Path | None, former: Path) -> ExitCode:
    """Save an avatar with what ``former`` has learned. Raises InputError and OutputError."""
    with TrainingExtra("training"):
        from ...models.train.regressors.takeover import taken_over
    check_moves(avatar)
    out = _place(avatar, out, [former])
    try:
        gem = load_gem(avatar)
        gem = replace(gem, regressor=taken_over(load_gem(former), gem))
    except ValueError as error:  # a GemFormatError or a RegressorError
        raise InputError(str(error)) from error
    save_learned(partial(save_gem, gem, basis=read_info(avatar).card.basis), out)
    print(f"{out}: has what {former} has learned")
    return ExitCode.OK
