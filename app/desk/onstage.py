"""The avatar on stage, the one that is coming, and what the window shows of it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ...models.gem import MODALITIES
from ...models.posing import pose_head
from ...render.compositing import over
from ...render.engines import Engine
from ..casting import Avatar
from ..ladder import Quality
from ..live import NO_SHIFT
from ..performance import Pose
from ..shots import Shot
from ..timing import Stopwatch
from . import explore
from .loader import Loader, Refused
from .measuring import Measuring, megabytes
from .painter import KERNELS, Image, Painter
from .roster import Roster
from .state import DeskState
from .view import AvatarFacts, Curve

SWITCH_SECS = 0.1
"""An avatar that nothing has driven after so long comes on stage at rest."""


class OnStage:
    """For the window's thread."""

    def __init__(
        self,
        roster: Roster,
        engine: Callable[[], Engine],
        size: tuple[int, int],
        watch: Stopwatch,
        warm: Callable[[], None],
    ) -> None:
        """``engine`` is opened with the first avatar, after ``warm`` has compiled what it needs in another thread;
        ``size``: width and height of the picture."""
        self.roster = roster
        self.avatar: Avatar | None = None
        self.shot: Shot | None = None
        """The last one that was for this avatar."""
        self.pose = Pose(np.zeros(0, np.float32), NO_SHIFT)
        """What the last picture shows."""
        self._open_engine, self._size, self._watch = engine, size, watch
        self._loader, self._measuring = Loader(lambda avatar: compiled(avatar, warm)), Measuring()
        self._painter: Painter | None = None
        self._coming: tuple[Avatar, float] | None = None
        self._drawn: tuple[object, ...] = ()
        self._used = 0

    @property
    def loading(self) -> str:
        """Name of what is being loaded."""
        return self._loader.loading.stem if self._loader.loading is not None else ""

    @property
    def engine(self) -> str:
        """What draws."""
        return "" if self._painter is None else f"{self._painter.engine.name}, {self._painter.engine.description}"

    @property
    def facts(self) -> AvatarFacts:
        """What is said of the avatar."""
        if self.avatar is None:
            return AvatarFacts()
        gem = self.avatar.gem
        counts = {name: len(gem.bases[name]) for name in MODALITIES}
        used = self._used or gem.components
        return AvatarFacts(gem.name, str(self.avatar.path), len(gem), counts, megabytes(gem, used), gem.about)

    @property
    def curve(self) -> Curve | None:
        """Its compression curve; None until it is measured."""
        return self._measuring.curve(self.avatar.sha256, self.avatar.gem) if self.avatar is not None else None

    @property
    def error_db(self) -> float | None:
        """PSNR of the last comparison."""
        return self._painter.error_db if self._painter is not None else None

    def call(self, path: Path | None) -> None:
        """Have an avatar opened; None asks for nothing."""
        if path is not None:
            self._loader.open(path)

    def arrived(self) -> Avatar | Refused | None:
        """What came of the last call."""
        return self._loader.newest()

    def await_shot(self, avatar: Avatar, now: float) -> None:
        """Let it come on stage with its first shot."""
        self._coming = (avatar, now + SWITCH_SECS)

    def take(self, shot: Shot | None, frozen: bool, now: float) -> tuple[Shot | None, bool]:
        """The shot if it is to be shown, and whether another avatar came on stage."""
        changed = False
        if self._coming is not None:
            avatar, until = self._coming
            if now > until or (shot is not None and shot.avatar == avatar.sha256):
                self.avatar, self._coming, changed = avatar, None, True
                self.shot = None
                self.roster = self.roster.staged(avatar.path)
                if self._painter is None:
                    self._painter = Painter(self._open_engine(), self._size, self._watch)
        fits = shot is not None and self.avatar is not None and shot.avatar == self.avatar.sha256
        if not fits or (frozen and self.shot is not None):
            return None, changed
        self.shot = shot
        return shot, changed

    def draw(self, state: DeskState, quality: Quality, fresh: bool, now: float) -> Image | None:
        """The picture that outputs get, when there is something new to be seen in it."""
        if self.avatar is None or self._painter is None:
            return None
        drawn = (self.avatar.sha256, state, quality)
        sweeps = state.exploring.on and state.exploring.sweep
        if not fresh and not sweeps and drawn == self._drawn:
            return None
        gem = self.avatar.gem
        self._drawn, self._used = drawn, quality.components
        driven = self.shot.pose if self.shot is not None else Pose(gem.rest_coefficients, NO_SHIFT)
        self.pose = explore.posed(gem, driven, state, now)
        return self._painter.picture(gem, self.pose, state, quality.components, quality.scale)

    def preview(self, picture: Image, state: DeskState) -> Image:
        """What the window shows of it: the comparison, while there is one."""
        if not state.compare or state.curtain or self._painter is None:
            return picture
        return self._painter.comparison(self.pose, state, picture)

    def close(self) -> None:
        """Let go of the engine, and end what loads and measures."""
        self._loader.close()
        self._measuring.close()
        if self._painter is not None:
            self._painter.engine.close()


def compiled(avatar: Avatar, warm: Callable[[], None]) -> None:
    """Compile what the window's thread will need for this avatar, or load it from disk: it must never wait for that.

    ``warm`` does so for what draws.
    """
    gem = avatar.gem
    warm()
    with KERNELS:
        splats = gem.compose(gem.rest_coefficients)
        pose_head(splats, gem.neck_weights, gem.neck_pivot, NO_SHIFT, NO_SHIFT)
        over(np.zeros((8, 8, 4), np.float32), (0.0, 0.0, 0.0))
