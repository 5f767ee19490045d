"""The avatar on stage, the one that is coming, and what the window shows of it."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ...models import blend, posing
from ...models.gem import MODALITIES
from ...render import compositing
from ...render.arrays import Image
from ...render.engines import Engine
from ..live import NO_SHIFT
from ..performing.casting import Avatar
from ..performing.ladder import Quality
from ..performing.performance import Pose
from ..performing.shots import Shot
from ..performing.timing import Watch
from . import explore
from .beside import Beside
from .loader import Loader, Refused
from .measuring import Measuring, megabytes
from .painter import KERNELS, Painter, curtain
from .roster import Roster
from .state import DeskState
from .view import AvatarFacts, Curve

SWITCH_SECS = 0.1
"""An avatar that nothing has driven after so long comes on stage at rest."""


@dataclass(frozen=True)
class Drawn:
    """A picture, and what it shows."""

    picture: Image
    """What outputs get: [H, W, 3], or [H, W, 4] with straight alpha; nothing of the avatar behind the curtain."""
    preview: Image
    """What the window shows of it: the comparison, while there is one."""
    pose: Pose | None
    """None behind the curtain."""
    avatar: str
    """sha256 of the avatar's file."""
    shot: Shot | None
    """What is seen for the first time in it."""
    secs: float
    """How long drawing took."""
    whole: bool
    """Whether nothing of it was left out because the machine is slow."""

    def behind_the_curtain(self) -> "Drawn":
        """The same with nothing of the avatar in it."""
        height, width = self.picture.shape[:2]
        picture = curtain(width, height)
        return replace(self, picture=picture, preview=picture, pose=None)


class OnStage:
    """For the window's thread; pictures are drawn beside it where the engine allows that."""

    def __init__(
        self,
        roster: Roster,
        engine: Callable[[], Engine],
        size: tuple[int, int],
        watch: Watch,
        warm: Callable[[], None],
        opened: Iterable[Avatar] = (),
    ) -> None:
        """``engine`` is opened with the first avatar, after ``warm`` has compiled what it needs in another thread;
        ``size``: width and height of the picture; ``opened``: avatars that need not be read again."""
        self.roster = roster
        self.avatar: Avatar | None = None
        self.shot: Shot | None = None
        """The last one that was for this avatar."""
        self._open_engine, self._size, self._watch = engine, size, watch
        self._loader, self._measuring = Loader(lambda avatar: compiled(avatar, warm), opened), Measuring()
        self._painter: Painter | None = None
        self._drawing: Beside[Drawn] = Beside("draw")
        self._coming: tuple[Avatar, float] | None = None
        self._drawn: tuple[object, ...] = ()
        self._drawn_at = 0.0
        self._used = 0

    @property
    def loading(self) -> str:
        """Name of what is being loaded."""
        return self._loader.loading.stem if self._loader.loading is not None else ""

    @property
    def coming(self) -> Path | None:
        """The file of the avatar that was asked for last, while it is not on stage."""
        return self._loader.loading or (self._coming[0].path if self._coming is not None else None)

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

    @property
    def free(self) -> bool:
        """Whether the next picture can be begun."""
        return self._drawing.free

    @property
    def bound(self) -> bool:
        """Whether pictures can only be drawn in the window's thread."""
        return self._painter is None or self._painter.engine.bound

    def rouse(self, waker: Callable[[], None]) -> None:
        """Have ``waker`` called, in whatever thread, when a picture is done."""
        self._drawing.rouse = waker

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

    def draw(
        self, state: DeskState, quality: Quality, shot: Shot | None, now: float, every: float = float("inf")
    ) -> None:
        """Begin the next picture while ``free``, when there is something new to be seen in it: ``shot``, for one.

        The same picture is drawn again after ``every`` seconds.
        """
        if self.avatar is None or self._painter is None:
            return
        drawn = (self.avatar.sha256, state, quality)
        sweeps = state.exploring.on and state.exploring.sweep
        if shot is None and not sweeps and drawn == self._drawn and now - self._drawn_at < every:
            return
        avatar, painter, gem = self.avatar, self._painter, self.avatar.gem
        self._drawn, self._drawn_at, self._used = drawn, now, quality.components
        driven = self.shot.pose if self.shot is not None else Pose(gem.rest_coefficients, NO_SHIFT)
        pose = explore.posed(gem, driven, state, now)
        whole = quality.scale == 1 and quality.components >= state.used_components

        def paint() -> Drawn:
            started = time.perf_counter()
            picture = preview = painter.picture(gem, pose, state, quality.components, quality.scale)
            if state.compare and not state.curtain:
                preview = painter.comparison(pose, state, picture)
            secs = time.perf_counter() - started
            shown = None if state.curtain else pose
            return Drawn(picture, preview, shown, avatar.sha256, shot, secs, whole)

        self._drawing.begin(paint, here=painter.engine.bound)

    def drawn(self) -> Drawn | None:
        """The picture that was begun, once, when it is done."""
        return self._drawing.result()

    def close(self) -> None:
        """Let go of the engine, and end what loads and measures."""
        self._loader.close()
        self._measuring.close()
        self._drawing.close()
        if self._painter is not None:
            self._painter.engine.close()


def compiled(avatar: Avatar, warm: Callable[[], None]) -> None:
    """Compile what the window's thread will need for this avatar, or load it from disk: it must never wait for that.

    ``warm`` does so for what draws. All is compiled before it is run, as nobody may draw meanwhile.
    """
    gem = avatar.gem
    for ahead in (warm, blend.warm, posing.warm, compositing.warm):
        ahead()
    with KERNELS:
        splats = gem.compose(gem.rest_coefficients)
        posing.pose_head(splats, gem.neck_weights, gem.neck_pivot, NO_SHIFT, NO_SHIFT)
        compositing.over(np.zeros((8, 8, 4), np.float32), (0.0, 0.0, 0.0))
