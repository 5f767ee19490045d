"""Training from the command line: the one way from here into ``models.train``, and only when it is asked for."""

from functools import partial
from pathlib import Path

from ..models.gemfile import read_info, save_gem
from .errors import ExitCode, InputError
from .places import check_places, save_learned
from .progress import ProgressBar


def run_training(
    avatar: Path, out: Path | None, videos: list[Path], companions: list[Path], pictures: int, steps: int, seed: int
) -> ExitCode:
    """Train the regressor of an avatar file and save the avatar with it. Raises InputError and OutputError."""
    try:
        from ..models.train.response import AvatarNotSeen
        from ..models.train.train_regressor import train_regressor
    except ImportError as error:
        raise InputError(f"training needs {error.name}; install it: pip install 'gemheads[train]'") from error
    for video in videos:
        if not video.is_file():
            raise InputError(f"{video}: no such video; check the path")
    out = out or avatar
    check_places(out)
    try:
        with ProgressBar() as bar:
            gem, report = train_regressor(
                avatar,
                companions=companions,
                videos=videos,
                pictures=pictures,
                steps=steps,
                seed=seed,
                progress=bar.reach,
            )
    except (ValueError, AvatarNotSeen) as error:  # a GemFormatError, or what is wrong with a video
        raise InputError(str(error)) from error
    save_learned(partial(save_gem, gem, basis=read_info(avatar).card.basis), out)
    print(
        f"{out}: regressor trained on {report.pictures} pictures; the avatar's response is known to"
        f" R2 {report.response_r2:.2f}; mismatch with people {report.start_mismatch:.2f} -> {report.end_mismatch:.2f}"
    )
    return ExitCode.OK
