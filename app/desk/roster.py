"""Which avatars can be chosen, in which order: those of the library, then what was opened from elsewhere."""

from dataclasses import dataclass, replace
from pathlib import Path


@dataclass(frozen=True)
class Roster:
    """Avatars by number, and the one on stage."""

    paths: tuple[Path, ...]
    current: int = 0
    """Index of the one on stage."""

    @property
    def names(self) -> tuple[str, ...]:
        """What people call them."""
        return tuple(path.stem for path in self.paths)

    def numbered(self, number: float) -> Path | None:
        """The avatar of a key, from 1; None where there is none."""
        index = round(number) - 1
        return self.paths[index] if 0 <= index < len(self.paths) else None

    def beside(self, steps: int) -> Path | None:
        """The avatar so many places on, in a circle; None where there are none."""
        return self.paths[(self.current + steps) % len(self.paths)] if self.paths else None

    def staged(self, path: Path) -> "Roster":
        """The roster with this avatar on stage, at its end if it is new."""
        paths = self.paths if path in self.paths else (*self.paths, path)
        return replace(self, paths=paths, current=paths.index(path))
