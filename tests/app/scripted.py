"""A world without devices and without waiting: a clock that is turned by hand, a source and a tracker that obey."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from faces import face
from gemheads.app.feed.loop import Loop
from gemheads.app.files.frames import Frame
from gemheads.app.inputs.source import Delivery, Kind, SourceLost, Transport
from gemheads.app.performing.casting import Avatar
from gemheads.app.performing.shots import Shot
from gemheads.models import arkit
from gemheads.models.driver.detector import Detection
from gemheads.models.driver.face import Box, FaceObservation
from gemheads.models.driver.region import Region
from gemheads.models.gem import Gem
from gems import ball

RATE = 30
GEM = ball()


def avatar(seed: int = 0, arkit: bool = True) -> Avatar:
    gem: Gem = ball(seed)
    return Avatar(gem if arkit else replace(gem, arkit_weights=None), Path("tiny.gem"), f"sha of {seed}")


@dataclass
class Clock:
    now: float = 100.0

    def __call__(self) -> float:
        return self.now


@dataclass
class Person:
    """A tracker that sees what it is told to see; every look takes ``secs`` of the clock."""

    clock: Clock
    face: FaceObservation | None = None
    others: list[Box] = field(default_factory=list)
    secs: float = 0.0
    looks: int = 0
    resets: int = 0
    locked: list[Box] = field(default_factory=list)
    broken: Exception | None = None

    def track(self, rgb: np.ndarray, locked: Box | None = None) -> FaceObservation | None:
        if self.broken:
            raise self.broken
        self.looks += 1
        self.clock.now += self.secs
        return self.face

    def detect(self, rgb: np.ndarray) -> list[Detection]:
        boxes = ([self.face.box_px] if self.face else []) + self.others
        return [Detection(box, 0.9, Region(box[0], box[1], 80.0, 0.0)) for box in boxes]

    def lock(self, face: Detection) -> None:
        self.locked.append(face.box_px)

    def reset(self) -> None:
        self.resets += 1


@dataclass
class Source:
    """Delivers what is put into ``next``, once."""

    kind: Kind = "camera"
    transport: Transport | None = None
    name: str = "the camera"
    next: Delivery | None = None
    lost: Exception | None = None
    drops: int = 0
    rejected: int = 0
    closed: int = 0

    def read(self, timeout: float) -> Delivery | None:
        if self.lost:
            raise self.lost
        found, self.next = self.next, None
        return found

    def close(self) -> None:
        self.closed += 1


def picture(number: int = 0, size: tuple[int, int] = (64, 48), luma: int = 130) -> np.ndarray:
    """[H, W, 3] one colour but for some pixels, which tell it from the others."""
    rgb = np.full((size[1], size[0], 3), luma, np.uint8)
    rgb[::7, ::7, 0] = number % 251
    return rgb


class World:
    """A loop, what drives it, and everything it made."""

    def __init__(self, source: Source | None = None) -> None:
        self.clock = Clock()
        self.person = Person(self.clock, face())
        self.source = source or Source()
        self.opened: list[float] = []
        self.refusal: Exception | None = None
        self.works: list[Callable[[], None]] = []
        """What was to be run elsewhere, while ``hangs``."""
        self.hangs = False
        self.loop = Loop(avatar(), lambda: self.person, self.clock, lambda _: None, self._spawn)
        self.shots: list[Shot] = []
        self.count = 0
        self.loop.use(self.open, self.source.name)

    def open(self) -> Source:
        self.opened.append(self.clock.now)
        if self.refusal:
            raise self.refusal
        return self.source

    def _spawn(self, work: Callable[[], None]) -> None:
        self.works.append(work) if self.hangs else work()

    def frame(self, rgb: object = None) -> Frame:
        self.count += 1
        image = picture(self.count) if rgb is None else rgb
        return Frame(image, round(self.clock.now * 1e6), Fraction(1, 1_000_000))  # pyright: ignore[reportArgumentType]

    def play(self, secs: float, make: Callable[[], Delivery | None] | None = None, rate: float = RATE) -> list[Shot]:
        """So much time, with a delivery each frame; returns the shots of this time."""
        begun = len(self.shots)
        for _ in range(round(secs * rate)):
            self.clock.now += 1 / rate
            self.source.next = (make or self.frame)()
            self.turn()
        return self.shots[begun:]

    def silence(self, secs: float) -> list[Shot]:
        """So much time without any delivery."""
        return self.play(secs, lambda: None)

    def turn(self) -> None:
        self.loop.turn()
        if (shot := self.loop.shots.take()) is not None:
            self.shots.append(shot)

    @property
    def phase(self) -> str:
        return self.loop.health.phase


def unplugged() -> SourceLost:
    return SourceLost("The camera went away.", "Plug it in again.", True)


def followed() -> World:
    """A camera and a person who has been there for seven seconds: the neutral is known."""
    world = World()
    world.play(7.0)
    assert world.phase == "tracking"
    assert world.loop.health.settled
    return world


def opened(world: World, secs: float = 1.0) -> list[Shot]:
    """The person opens the mouth."""
    world.person.face = face(jaw=0.5)
    return world.play(secs)


def jaw(shots: list[Shot]) -> np.ndarray:
    """How far the mouth is open, about 0 to 1.15, by the avatar's own map of the ARKit shapes."""
    assert GEM.arkit_weights is not None
    opened = GEM.arkit_weights[arkit.NAMES.index("jawOpen")].astype(float)
    return np.array([(shot.pose.coefficients - GEM.rest_coefficients) @ opened / (opened @ opened) for shot in shots])
