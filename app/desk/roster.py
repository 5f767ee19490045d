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

    def beside(self, steps: int, coming: Path | None = None) -> Path | None:
        """The avatar so many places on from the one on stage, or from the one that is ``coming``, in a circle; None
        where there are none."""
        begin = self.paths.index(coming) if coming in self.paths else self.current
        return self.paths[(begin + steps) % len(self.paths)] if self.paths else None

    def staged(self, path: Path) -> "Roster":
        """The roster with this avatar on stage, at its end if it is new: by its whole path, which means the same from
        whatever folder."""
        known = [one.resolve() for one in self.paths]
        path = path.resolve()
        if path in known:
            return replace(self, current=known.index(path))
        return replace(self, paths=(*self.paths, path), current=len(self.paths))
