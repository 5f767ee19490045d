"""What the panels read: one value a frame, put together by the loop."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..inputs.source import Transport
from ..performing.shots import Health, Shot
from .keys import Keymap, keymap
from .state import DeskState


@dataclass(frozen=True)
class Toast:
    """A message that stays for some seconds."""

    text: str
    alarm: bool = False
    topic: str = ""
    """Another message on the same topic takes its place; "" for messages that stand alone."""


@dataclass(frozen=True)
class AvatarFacts:
    """What is said of the avatar on stage."""

    name: str = ""
    path: str = ""
    splats: int = 0
    mode_counts: Mapping[str, int] = field(default_factory=dict)
    """Modality -> components stored."""
    megabytes: float = 0.0
    """Of the components in use, as stored in memory."""
    about: Mapping[str, str] = field(default_factory=dict)
    """author, licence, consent, source."""


@dataclass(frozen=True)
class Curve:
    """How good the avatar is with fewer components: one row a count."""

    components: NDArray[np.float64]
    """[M] counts, rising."""
    megabytes: NDArray[np.float64]
    """[M] memory of the bases."""
    decibels: NDArray[np.float64]
    """[M] PSNR in dB against all components."""

    def decibels_at(self, components: int) -> float:
        """PSNR in dB at a count, between those that were measured; NaN before any was."""
        return float(np.interp(components, self.components, self.decibels)) if len(self.components) else float("nan")


@dataclass(frozen=True)
class Readings:
    """How fast it goes."""

    fps: float = 0.0
    stages: Mapping[str, float] = field(default_factory=dict)
    """Seconds by stage."""
    latency: float = 0.0
    """Seconds from the frame's delivery to the swap, median."""
    drops: int = 0
    megabytes: float = 0.0
    """Memory of this process."""
    engine: str = ""
    """What draws, and by which renderer."""
    provider: str = ""
    """What the networks run on."""
    lowered: str = ""
    """What the quality ladder takes from the picture that is shown, one sentence; empty at full quality."""


@dataclass(frozen=True)
class Rest:
    """How the taking of a neutral goes."""

    green: bool = False
    """Whether the coach is content."""
    sentences: tuple[str, ...] = ()
    countdown: float | None = None
    """Seconds left."""
    progress: float | None = None
    """Share of the features taken, in [0, 1]."""
    result: str = ""
    score: float | None = None
    """||k|| / sigma that is left, less is better; ``restface.judge`` says how little is accepted."""


@dataclass(frozen=True)
class OutputLine:
    """How one output does."""

    name: str
    status: str
    drops: int = 0
    failed: bool = False
    over: bool = False
    """Whether this is its last word."""


@dataclass(frozen=True)
class DeskView:
    """Everything that is shown but the picture."""

    state: DeskState = field(default_factory=DeskState)
    keymap: Keymap = field(default_factory=keymap)
    avatars: tuple[str, ...] = ()
    """Names, in the order of the keys 1 to 9."""
    on_stage: int = 0
    loading: str = ""
    """Name of what is being loaded, empty when nothing is."""
    avatar: AvatarFacts = field(default_factory=AvatarFacts)
    health: Health = field(default_factory=Health)
    shot: Shot | None = None
    cameras: tuple[str, ...] = ()
    transport: Transport | None = None
    readings: Readings = field(default_factory=Readings)
    curve: Curve | None = None
    rest: Rest = field(default_factory=Rest)
    outputs: tuple[OutputLine, ...] = ()
    toasts: tuple[Toast, ...] = ()
    swept: float = 0.0
    """Where the sweep of the explored component is, in sigma."""
    error_db: float | None = None
    """PSNR of the comparison on screen."""
