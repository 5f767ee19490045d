"""Avatars that drivers drive, by their regressors and by the baseline that learned nothing."""

from collections.abc import Mapping
from dataclasses import dataclass

from ...models.crossing.mirror import Mirror
from ...models.driver.answer import Express
from ...models.gem import Gem
from ..making.opencapture import is_run
from ..performing.casting import Driving, expression_of, open_avatar
from .entrants import Entrant

SIZE = 384
"""Side of an avatar's picture, pixels."""
WORDS: Mapping[Driving, str] = {"learned": "regressor", "baseline": "baseline"}
"""What drives, as tables call it."""


@dataclass(frozen=True)
class Trial:
    """One avatar by one way of driving it."""

    avatar: str
    """Its column's name."""
    sha256: str
    """Of its file."""
    driving: Driving
    express: Express
    mirror: Mirror

    @property
    def gem(self) -> Gem:
        """The avatar."""
        return self.mirror.gem

    @property
    def made_of(self) -> list[object]:
        """What its pictures depend on, beside the driver."""
        return [self.sha256, self.driving, SIZE]


def trials(entrant: Entrant, notes: list[str]) -> list[Trial]:
    """All ways of driving one avatar, the regressor first; ``notes`` gets what cannot be, a sentence each.

    Raises InputError.
    """
    name = entrant.column.name
    if is_run(entrant.path):
        notes.append(f"{name} is a run, which a face cannot drive; distill makes a .gem of it.")
        return []
    avatar = open_avatar(entrant.path)
    ways: list[Driving] = []
    if avatar.gem.regressor is not None:
        ways.append("learned")
    if avatar.gem.arkit_weights is not None:
        ways.append("baseline")
    if not ways:
        notes.append(f"{name} is left out: it has neither a regressor nor ARKit shapes, so no face can drive it.")
        return []
    if ways == ["baseline"]:
        notes.append(f"{name} has no regressor: only the baseline drives it.")
    if ways == ["learned"]:
        notes.append(f"{name} knows no ARKit shapes: there is no baseline beside its regressor.")
    mirror = Mirror(avatar.gem, SIZE)
    return [Trial(name, avatar.sha256, way, expression_of(avatar, way), mirror) for way in ways]
