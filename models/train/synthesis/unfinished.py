"""What a refinement has come to, kept beside its result: killed, the same one goes on from there."""

import io
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch

from ...wholefile import partials_of, write_whole
from .freegem import State


@dataclass
class Course:
    """How a refinement goes."""

    before: float
    """Decibels of the avatar that came ..."""
    best: float
    """... and of the best that was found ..."""
    kept: State
    """... which is this one."""
    done: int = 0
    """Steps."""
    curve: list[tuple[int, float]] = field(default_factory=list)
    """Steps done and decibels there."""
    losses: list[float] = field(default_factory=list)


class Unfinished:
    """A file that is there while somebody refines, and for no longer."""

    def __init__(self, path: Path, identity: str) -> None:
        """``identity`` tells all apart that would come to something else."""
        self._path, self._identity = path, identity

    def read(self) -> dict[str, Any] | None:
        """What was kept; None where there is nothing, or something broken, or that of another refinement."""
        try:
            found = torch.load(self._path, map_location="cpu", weights_only=True)
            return dict(found["state"]) if found["identity"] == self._identity else None
        except Exception:  # torch names many; without it all is done again
            return None

    def write(self, state: dict[str, Any]) -> None:
        """Keep tensors and numbers in place of what was kept before. A disk that takes none is no reason to stop."""
        packed = io.BytesIO()
        torch.save({"identity": self._identity, "state": state}, packed)
        with suppress(OSError):
            write_whole(self._path, [packed.getbuffer()])

    def remove(self) -> None:
        """It is finished; what runs left that were killed while they wrote goes, too."""
        with suppress(OSError):
            for file in (self._path, *partials_of(self._path)):
                file.unlink(missing_ok=True)
