"""A window without a display, and a session with everything in it made here."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.desk.driving import Driving
from gemheads.app.desk.keys import keymap
from gemheads.app.desk.offscreen import DeskOffscreen
from gemheads.app.desk.outputs import Outputs
from gemheads.app.desk.roster import Roster
from gemheads.app.desk.session import Session
from gemheads.app.desk.state import DeskState
from gemheads.app.live import NO_SHIFT
from gemheads.app.performing.casting import Avatar
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.shots import Health, Shot
from gemheads.models.gemfile import save_gem
from gemheads.render.contexts import NoOpenGLError
from gemheads.render.software import SoftwareEngine
from gems import ball

SIZE = (1100, 760)


@pytest.fixture
def desk() -> Iterator[DeskOffscreen]:
    """A window on EGL."""
    try:
        made = DeskOffscreen(SIZE)
    except NoOpenGLError as error:
        pytest.skip(str(error))
    yield made
    made.close()


@dataclass
class FakeCapture:
    """Stands for the capture thread: the test posts the shots."""

    avatar: Avatar
    health: Health = field(default_factory=Health)
    transport: Any = None
    calls: list[tuple[Any, ...]] = field(default_factory=list)
    waiting: list[Shot] = field(default_factory=list)
    answers_cast: bool = True
    serial: int = 0

    def post(self, moved: float = 0.0) -> Shot:
        """One more shot; ``moved``: by how many sigma its first coefficients are away from rest."""
        gem = self.avatar.gem
        self.serial += 1
        pose = Pose((gem.rest_coefficients + moved * gem.sigma).astype(np.float32), NO_SHIFT)
        shot = Shot(self.serial, pose, self.avatar.sha256, delivered=0.0, ready=0.0, source_secs=self.serial / 30)
        self.waiting = [shot]
        return shot

    def newest(self) -> Shot | None:
        return self.waiting.pop() if self.waiting else None

    def cast(self, avatar: Avatar) -> None:
        self.avatar = avatar
        if self.answers_cast:
            self.post()

    def __getattr__(self, name: str) -> Callable[..., None]:
        if name.startswith("_"):
            raise AttributeError(name)
        return lambda *arguments: self.calls.append((name, *arguments))


@dataclass
class Room:
    """A session, its capture and where its files are."""

    session: Session
    folder: Path
    captures: list[FakeCapture]

    @property
    def capture(self) -> FakeCapture:
        return self.captures[0]


@pytest.fixture
def avatars(tmp_path: Path) -> tuple[Path, ...]:
    """Two avatars that look different, and a file that is none."""
    folder = tmp_path / "avatars"
    folder.mkdir()
    for seed, name in enumerate(("anna", "berta")):
        save_gem(ball(seed), folder / f"{name}.gem")
    (folder / "broken.gem").write_bytes(b"no avatar at all")
    return tuple(folder / f"{name}.gem" for name in ("anna", "berta", "broken"))


@pytest.fixture
def room(tmp_path: Path, avatars: tuple[Path, ...]) -> Iterator[Room]:
    captures: list[FakeCapture] = []

    def made(avatar: Avatar) -> FakeCapture:
        captures.append(FakeCapture(avatar))
        return captures[-1]

    folder = tmp_path / "made"
    session = Session(
        DeskState(welcome=False),
        Roster(avatars),
        keymap(),
        SoftwareEngine,
        Outputs((96, 96), 30, lambda: folder),
        size=(96, 96),
        driving=Driving(lambda words, alarm: session.tell(words, alarm), made),
    )
    yield Room(session, folder, captures)
    session.close()
