"""What somebody asks `live` for."""

from dataclasses import dataclass

from ...render.enginename import EngineName


@dataclass(frozen=True)
class LiveWish:
    """What the command line asks of the window."""

    driver: str | None = None
    """A video, a folder of pictures, a track, or ``osc:PORT``."""
    avatar: str | None = None
    """Name of an avatar or a .gem file; None for the one of the last run."""
    camera: str | None = None
    """A camera's name or a part of it; an empty one means the last one used, or the first."""
    components: int | None = None
    """How many components a modality; None for all."""
    size: tuple[int, int] = (512, 512)
    """Width and height of the avatar's picture in pixels."""
    engine: EngineName = "auto"
    listen: str | None = None
    """HOST:PORT for orders by OSC."""
    no_badge: str = ""
    """Why what is recorded carries no SYNTHETIC badge; empty: it carries one."""
