"""What every output is: something that takes pictures, in a thread of its own, and may take its time."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from ...render.arrays import Image
from ..credentials.origin import Origin
from ..performing.performance import Pose


@dataclass(frozen=True)
class Marks:
    """What outputs have to say about the pictures of now."""

    no_badge: str = ""
    """Why recordings and pictures carry no badge; empty where they carry one."""
    camera_badge: bool = False
    """Whether the virtual camera carries one too."""
    ground: tuple[int, int, int] = (0, 0, 0)
    """RGB of the last background that was not transparent, for files that know no alpha."""
    origins: Mapping[str, Origin] = field(default_factory=dict)
    """SHA-256 of an avatar's file -> whose face it is."""


@dataclass(frozen=True)
class Shown:
    """One picture as the window shows it, before any panel was drawn on it."""

    picture: Image
    """[H, W, 3] RGB or [H, W, 4] with straight alpha; nobody may write to it: all outputs share it."""
    shown_at: float
    """Seconds of ``time.perf_counter``."""
    pose: Pose | None = None
    """What the avatar does in it."""
    avatar: str = ""
    """SHA-256 of the avatar's file."""
    marks: Marks = field(default_factory=Marks)

    @property
    def origin(self) -> Origin | None:
        """Whose face it shows, where that is known."""
        return self.marks.origins.get(self.avatar)


class Outlet(Protocol):
    """An opened output; used by one thread."""

    @property
    def status(self) -> str:
        """How far it is, one short line for the person; read from other threads."""
        ...

    def send(self, shown: Shown) -> None:
        """Take one picture. Raises OutputError, which ends the output."""
        ...

    def close(self) -> None:
        """Finish and let go; called once, after a failure too. Raises OutputError."""
        ...


Opener = Callable[[], Outlet]
"""Opens an output, in its thread. Raises OutputError or UsageError."""
