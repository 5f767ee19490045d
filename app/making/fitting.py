"""``gemheads fit``: pictures of an avatar into the track that plays them again."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from ...models.driver.answer import Express
from ...models.driver.face import MOST_SIDE
from ...render.camera import Camera
from ..credentials.papers import driver_of
from ..errors import ExitCode, InputError, TrainingExtra, UsageError
from ..files.frames import Frame
from ..files.pictures import write_png
from ..files.places import check_places
from ..files.sources import Source, files_of, open_source
from ..performing.casting import Avatar, expression_of, open_avatar
from ..performing.performance import Pose
from ..performing.portrait import portrait
from ..performing.tracks import Track, save_track
from ..progress import ProgressBar
from ..words import read_colour
from .cameras import load_camera
from .firstguess import Guesser

if TYPE_CHECKING:
    from ...models.train.synthesis.fit import Effort, Fit

Colour = tuple[float, float, float]
PORTRAIT = "portrait"
AUTO = "auto"
LARGEST_SIDE = 512
"""Pictures are brought down to this before they are fitted: more pixels tell little more, and cost."""
LEAST_SIDE = 16
LOST_DB = 6.0
"""A frame that comes out so much worse than the one before is begun anew: a cut, most likely."""


@dataclass(frozen=True)
class FitWish:
    """What the command line asks for."""

    camera: str = PORTRAIT
    """``portrait`` is the view of `reenact`; else a JSON file."""
    background: str = AUTO
    """A colour, or ``auto``: that of the first picture's upper edge."""
    errors: Path | None = None
    thorough: bool = False
    rate: Fraction = Fraction(30)


@dataclass(frozen=True)
class Fitted:
    """One frame's outcome."""

    pts: int
    pose: Pose
    psnr: float
    seconds: float


def run_fitting(picture: str, out: Path, avatar: Path, wish: FitWish) -> ExitCode:
    """Fit every frame of a picture or video and save the track. Raises CommandError.

    Stopped with Ctrl-C, it keeps the track up to there and returns INTERRUPTED.
    """
    with TrainingExtra("fitting"):
        from ...models.train.synthesis import fit as _  # noqa: F401 (only whether it can be had)
    source = open_source(picture, wish.rate, MOST_SIDE)  # a camera counts in the pixels of the file
    cast = open_avatar(avatar)
    camera = None if wish.camera == PORTRAIT else Path(wish.camera)
    check_places(out, wish.errors, read=[*files_of(picture), avatar, camera])
    fitter = _Fitter(cast, source, wish)
    frames: list[Fitted] = []
    code = ExitCode.OK
    with ProgressBar() as bar:
        bar.begin(out.name, source.frame_count)
        try:
            for fitted in fitter.fitted():
                frames.append(fitted)
                bar.advance()
        except KeyboardInterrupt:
            code = ExitCode.INTERRUPTED
    if not frames:
        return code
    poses = tuple(fitted.pose for fitted in frames)
    pts = np.array([fitted.pts for fitted in frames], np.int64)
    driver = driver_of(picture, None).sha256
    save_track(Track(cast.gem.name, cast.sha256, source.time_base, source.rate, pts, poses, driver), out)
    if wish.errors is not None:
        write_png(fitter.worst, wish.errors)
    print(_told(out, frames))
    return code


def _told(out: Path, frames: list[Fitted]) -> str:
    quality = np.array([fitted.psnr for fitted in frames])
    pace = np.median([fitted.seconds for fitted in frames[1:] or frames])
    text = f"{out}: {len(frames)} frames, {np.median(quality):.1f} dB"
    if len(frames) > 1:
        text += f" (least {quality.min():.1f} in frame {quality.argmin()})"
    return f"{text}, {pace:.2f} s a frame"


class _Fitter:
    """Frames into fits, each beginning at the one before."""

    def __init__(self, cast: Avatar, source: Source, wish: FitWish) -> None:
        from ...models.train.synthesis.fit import FIRST, THOROUGH

        self._gem, self._avatar, self._source = cast.gem, cast.path, source
        self._effort: Effort = THOROUGH if wish.thorough else FIRST
        width, height = source.size
        share = min(1.0, LARGEST_SIDE / max(width, height))
        self._size = max(LEAST_SIDE, round(width * share)), max(LEAST_SIDE, round(height * share))
        self._camera = self._seen_by(wish, width, height)
        first = next(iter(source.frames())).rgb
        self._background = _ground(wish.background, first)
        self._guesser = Guesser(self._gem, self._camera, self._background, _express(cast))
        self.worst: NDArray[np.uint8] = np.zeros((1, 1, 3), np.uint8)
        """[H, 3 W, 3] the frame that fits least: picture, fit, and where they differ."""
        self._least = np.inf

    def fitted(self) -> Iterator[Fitted]:
        """Every frame in order."""
        from ...models.train.synthesis.fit import NEXT

        before: Fit | None = None
        for frame in self._source.frames():
            rgb = self._brought_down(frame)
            found = None if before is None else self._fit(rgb, before, NEXT)
            if found is None or before is None or found.psnr < before.psnr - LOST_DB:
                anew = self._fit(rgb, None, self._effort)
                found = anew if found is None or anew.psnr > found.psnr else found
            before = found
            yield self._kept(frame, rgb, found)

    def _fit(self, rgb: NDArray[np.uint8], before: "Fit | None", effort: "Effort") -> "Fit":
        from ...models.train.synthesis.fit import HeadPose, Start, fit

        start = None if before is None else before.start
        if start is None and (guess := self._guesser.guess(rgb)) is not None:
            start = Start(guess.coefficients, HeadPose(guess.turn, guess.move))
        try:
            return fit(self._gem, [rgb], [self._camera], self._background, start, effort)
        except ValueError as error:
            raise InputError(f"{self._avatar}: cannot be fitted: {error}") from error

    def _kept(self, frame: Frame, rgb: NDArray[np.uint8], found: "Fit") -> Fitted:
        from ...models.train.synthesis.fit import error_map

        if found.psnr < self._least:
            self._least = found.psnr
            drawn = np.round(255 * np.clip(found.pictures[0], 0, 1)).astype(np.uint8)
            self.worst = np.concatenate([rgb, drawn, error_map(found.pictures[0], rgb)], 1)
        share = self._gem.limit_share(found.coefficients)
        pose = Pose(found.coefficients, found.pose.turn, clamped=share, translation=found.pose.move)
        return Fitted(frame.pts, pose, found.psnr, found.seconds)

    def _brought_down(self, frame: Frame) -> NDArray[np.uint8]:
        height, width = frame.rgb.shape[:2]
        if (width, height) == self._size:
            return frame.rgb
        if (width, height) != tuple(self._source.size):
            raise InputError(
                f"{self._source.path}: a frame is {width}x{height}, the first {self._source.size[0]}x"
                f"{self._source.size[1]}; give pictures of one size"
            )
        return np.asarray(cv2.resize(frame.rgb, self._size, interpolation=cv2.INTER_AREA), np.uint8)

    def _seen_by(self, wish: FitWish, width: int, height: int) -> Camera:
        if wish.camera == PORTRAIT:
            return portrait(self._gem.viewing, *self._size)
        camera = load_camera(Path(wish.camera))
        if (camera.width, camera.height) != (width, height):
            raise InputError(
                f"{wish.camera}: is a camera of {camera.width}x{camera.height}, {self._source.path} is"
                f" {width}x{height}; give the one that took it"
            )
        return camera.scaled(*self._size)


def _express(cast: Avatar) -> Express | None:
    """What the avatar has to turn a face into its coefficients, the better first; None where it has nothing."""
    if cast.gem.regressor is not None:
        return expression_of(cast, "learned")
    return None if cast.gem.arkit_weights is None else expression_of(cast, "baseline")


def _ground(said: str, first: NDArray[np.uint8]) -> Colour:
    if said != AUTO:
        colour = read_colour(said)
        if colour is None:
            raise UsageError("--background transparent: a picture has a ground; give its colour, or auto")
        return colour
    edge = np.concatenate([first[0], first[: len(first) // 4, 0], first[: len(first) // 4, -1]])
    red, green, blue = (float(value) / 255 for value in np.median(edge, 0))
    return red, green, blue
