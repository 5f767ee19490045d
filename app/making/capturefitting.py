"""``gemheads fit`` on a capture: each moment from several cameras at once, into the track that plays it."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.captures.layout import CaptureError
from ..errors import ExitCode, InputError, TrainingExtra
from ..files.pictures import write_png
from ..files.places import check_places
from ..performing.casting import open_avatar
from ..performing.performance import Pose
from ..progress import ProgressBar
from .likeness import tell_of_unlikeness
from .moments import save_moments
from .opencapture import chosen, opened

if TYPE_CHECKING:
    from ...models.train.synthesis.fitcapture import FittedMoment


@dataclass(frozen=True)
class CaptureWish:
    """What the command line asks for."""

    split: str = "test"
    cameras: str | None = None
    """Indices such as "0,3"; None takes some, spread over all."""
    errors: Path | None = None
    thorough: bool = False


def run_capture_fitting(capture: Path, out: Path, avatar: Path, wish: CaptureWish) -> ExitCode:
    """Fit every moment of a split and save the track. Raises CommandError.

    Stopped with Ctrl-C, it keeps the track up to there and returns INTERRUPTED.
    """
    with TrainingExtra("fitting"):
        from ...models.train.synthesis.fit import THOROUGH
        from ...models.train.synthesis.fitcapture import ALONE, fit_moments
    cast, footage = open_avatar(avatar), opened(capture)
    shots = chosen(footage, wish.split, wish.cameras)
    check_places(out, wish.errors, read=[capture, avatar])
    poses: dict[int, Pose] = {}
    quality: list[float] = []
    seconds: list[float] = []
    worst: FittedMoment | None = None
    code = ExitCode.OK
    with ProgressBar() as bar:
        bar.begin(out.name, len({shot.timestep for shot in shots}))
        try:
            for moment in fit_moments(cast.gem, footage, shots, THOROUGH if wish.thorough else ALONE):
                fit = moment.fit
                share = cast.gem.limit_share(fit.coefficients)
                poses[moment.timestep] = Pose(fit.coefficients, fit.pose.turn, clamped=share, translation=fit.pose.move)
                quality.append(fit.psnr)
                seconds.append(fit.seconds)
                if worst is None or fit.psnr < worst.fit.psnr:
                    worst = moment
                bar.advance()
        except CaptureError as error:
            raise InputError(str(error)) from error
        except ValueError as error:
            raise InputError(f"{avatar}: cannot be fitted: {error}") from error
        except KeyboardInterrupt:
            code = ExitCode.INTERRUPTED
    if worst is None:
        return code
    save_moments(cast.gem.name, cast.sha256, poses, out)
    if wish.errors is not None:
        write_png(_sheet(worst), wish.errors)
    views = len({shot.camera_index for shot in shots})
    text = f"{out}: {len(poses)} moments from {views} cameras, {np.median(quality):.1f} dB"
    print(f"{text} (least {min(quality):.1f} at timestep {worst.timestep}), {np.median(seconds):.2f} s a moment")
    tell_of_unlikeness(avatar, capture, float(np.median(quality)))
    return code


def _sheet(moment: "FittedMoment") -> NDArray[np.uint8]:
    """A row for each view: picture, fit, and where they differ; views may differ in size."""
    from ...models.train.synthesis.fit import error_map

    rows = []
    for picture, fitted in zip(moment.pictures, moment.fit.pictures, strict=True):
        drawn = np.round(255 * np.clip(fitted, 0, 1)).astype(np.uint8)
        rows.append(np.concatenate([picture, drawn, error_map(fitted, picture)], 1))
    width = max(row.shape[1] for row in rows)
    return np.concatenate([np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0))) for row in rows])
