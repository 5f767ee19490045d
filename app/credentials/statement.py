"""What a result says about itself, and how C2PA wants to have it said."""

from dataclasses import asdict, dataclass
from importlib import metadata
from typing import Any

from .origin import Origin

LABEL = "gemheads.synthetic"
"""Of the assertion that is ours."""
_TERMS = "http://cv.iptc.org/newscodes/digitalsourcetype/"
AVATAR_ALONE = _TERMS + "trainedAlgorithmicMedia"
"""IPTC: created algorithmically using a model derived from sampled content. Avatars that were modelled by hand are said
to be so too, because trained networks drive them: the stronger word misleads nobody."""
WITH_DRIVER = _TERMS + "compositeWithTrainedAlgorithmicMedia"
"""IPTC: that, composited with other media: here the driver's own picture beside it."""
SENTENCE = "Computer-made: the face, and what it does, were drawn by gemheads; nobody filmed this."


@dataclass(frozen=True)
class Driver:
    """Who drove the avatar, as far as it may be told: contents by their hash, never a name that nobody asked for."""

    kind: str
    """video, pictures, track or live."""
    sha256: str = ""
    """Of the file's bytes, or of many (``files_sha256``): whoever has them can prove that it was these, nobody else
    learns anything."""
    name: str = ""
    """Of the file; only when asked for."""


@dataclass(frozen=True)
class Statement:
    """All that is signed."""

    origins: tuple[Origin, ...]
    """The avatars that are seen."""
    driver: Driver
    no_badge: str = ""
    """Why no badge was drawn; empty where there is one."""
    beside: bool = False
    """Whether the driver's picture is seen too."""
    along: Driver | None = None
    """What was given beside a track: its sound is heard, and its picture may be seen."""


def manifest(statement: Statement) -> dict[str, Any]:
    """The manifest's definition for c2pa."""
    generator = {"name": "gemheads", "version": metadata.version("gemheads")}
    names = ", ".join(origin.name for origin in statement.origins) or "an avatar"
    badge = {"drawn": False, "reason": statement.no_badge} if statement.no_badge else {"drawn": True}
    made = {
        "action": "c2pa.created",
        "digitalSourceType": WITH_DRIVER if statement.beside else AVATAR_ALONE,
        "softwareAgent": generator,
    }
    ours = {
        "statement": SENTENCE,
        "avatars": [origin.as_json() for origin in statement.origins],
        "driver": _told(statement.driver),
        "badge": badge,
    }
    if statement.along is not None:
        ours["along"] = _told(statement.along)
    return {
        "claim_generator_info": [generator],
        "title": f"{names}, computer-made",
        "assertions": [
            {"label": "c2pa.actions", "data": {"actions": [made]}},
            {"label": LABEL, "kind": "Json", "data": ours},
        ],
    }


def _told(driver: Driver) -> dict[str, str]:
    return {key: text for key, text in asdict(driver).items() if text}
