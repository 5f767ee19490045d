"""Who plays: an avatar's file opened and joined with what drives it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...models import arkit
from ...models.brevity import brief
from ...models.driver.answer import Express, by_scores
from ...models.driver.regressor import Regressor, RegressorError
from ...models.gem import CLAMP_SIGMAS, Gem
from ...models.gemfile import GemFormatError, load_gem
from ...models.wholefile import file_sha256
from ..errors import InputError, UsageError
from .tracks import Track

BEYOND = 10.0
"""A track whose coefficients go so many times as far as the avatar's is none of its."""
Driving = Literal["learned", "baseline"]


@dataclass(frozen=True)
class Avatar:
    """An opened avatar file."""

    gem: Gem
    path: Path
    sha256: str

    @property
    def lids(self) -> NDArray[np.floating]:
        """[coefficients] what closes both lids; zeros where the avatar does not know."""
        if self.gem.arkit_weights is None:
            return np.zeros_like(self.gem.rest_coefficients)
        return self.gem.arkit_weights[[arkit.NAMES.index(f"eyeBlink{side}") for side in ("Left", "Right")]].sum(0)


def open_avatar(path: Path) -> Avatar:
    """Open a .gem file. Raises InputError with the reason when it is not one, within bounded memory and time."""
    try:
        gem = load_gem(path)  # first: it refuses what is endless, huge or no avatar, unread
        return Avatar(gem, path, file_sha256(path))
    except GemFormatError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions") from error


def check_components(avatar: Avatar, components: int | None) -> None:
    """Raises UsageError when the avatar stores fewer components than asked for."""
    stored = avatar.gem.components
    if components is not None and not 1 <= components <= stored:
        cure = f"choose from 1 to {stored}" if stored else "leave it out"
        raise UsageError(f"--components {components}: {avatar.path} stores {stored}; {cure}")


def check_track(avatar: Avatar, track: Track, path: Path) -> None:
    """Raises InputError when the track of this file was made for another avatar."""
    width = track.poses[0].coefficients.size
    if track.avatar_sha256 != avatar.sha256 or width != avatar.gem.coefficient_count:
        raise InputError(
            f"{path}: was made for {brief(track.avatar)}, not for {avatar.path}; give that avatar, or track again"
        )
    gem = avatar.gem
    reach = BEYOND * np.maximum(CLAMP_SIGMAS * gem.sigma, np.abs(gem.rest_coefficients))
    if any((np.abs(pose.coefficients) > reach).any() for pose in track.poses):
        raise InputError(f"{path}: asks for coefficients far beyond 3 sigma, which no track has; track again")


def expression_of(avatar: Avatar, driving: Driving) -> Express:
    """What turns relative features and rotation into what this avatar does. Raises InputError when it has none."""
    gem = avatar.gem
    if driving == "baseline":
        if gem.arkit_weights is None:
            other = "use --driver learned" if gem.regressor is not None else _taught(avatar)
            raise InputError(f"{avatar.path}: knows no ARKit shapes, so scores do not drive it; {other}")
        return by_scores(gem)
    if gem.regressor is None:
        other = "" if gem.arkit_weights is None else ", or use --driver baseline"
        raise InputError(
            f"{avatar.path}: has no regressor, so nothing turns a face into its expressions; {_taught(avatar)}{other}"
        )
    try:
        return Regressor.of(gem)
    except RegressorError as error:
        raise InputError(f"{avatar.path}: {error}") from error


def _taught(avatar: Avatar) -> str:
    return f"train one with `gemheads train-regressor {avatar.path}`"
