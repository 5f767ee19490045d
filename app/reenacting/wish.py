"""What somebody asks `reenact` for."""

from dataclasses import dataclass, fields
from fractions import Fraction
from pathlib import Path

from ...render.enginename import EngineName
from ..files.crop import WHOLE, Crop
from ..performing.casting import Driving
from ..person.neutrals import AUTO, NeutralRule


@dataclass(frozen=True)
class Wish:
    """What the command line asks for; the same for every driver."""

    avatar: Path
    components: int | None = None
    size: tuple[int, int] = (512, 512)
    neutral: NeutralRule = AUTO
    crop: Crop = WHOLE
    """What is looked at of the drivers' pictures, and shown beside the avatar."""
    side_by_side: bool = False
    background: tuple[float, float, float] | None = (0.75, 0.75, 0.75)
    head_pose: bool = True
    resume: bool = False
    engine: EngineName = "auto"
    driving: Driving = "learned"
    rate: Fraction = Fraction(30)
    """Frames per second of drivers that are pictures."""
    track: Path | None = None
    """Play this performance instead of following a face."""
    no_badge: str = ""
    """Why the SYNTHETIC badge is left out; empty draws it."""
    name_driver: bool = False
    """Whether the driver's file name goes into the credentials."""

    def settings(self) -> dict[str, str]:
        """What decides how results look, beside the files that are named and the neutral that is found."""
        others = {"avatar", "track", "neutral", "resume", "engine"}
        names = [part.name for part in fields(self) if part.name not in others]
        return {name.replace("_", " "): str(getattr(self, name)) for name in names}
