"""Whose face it is: what an avatar's file says about its origin, as one line for the person and for credentials."""

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..performing.casting import Avatar

LONGEST_TEXT = 600
"""More of a text from a file is not shown."""
UNRECORDED = "not recorded"


@dataclass(frozen=True)
class Origin:
    """An avatar's name, its file, and what its card says; texts are plain, and empty where the card says nothing."""

    name: str
    sha256: str
    """Of the file."""
    author: str = ""
    licence: str = ""
    consent: str = ""
    source: str = ""

    @property
    def consented(self) -> bool:
        """Whether anything is recorded about consent; what, is for people to read."""
        return bool(self.consent)

    def said(self) -> str:
        """One line: licence and consent, or that there is none."""
        return f"{self.name}: licence {self.licence or 'not stated'}; {self.consent_said()}"

    def consent_said(self) -> str:
        """Half a sentence."""
        return f"consent: {self.consent}" if self.consented else NO_CONSENT

    def as_json(self) -> dict[str, str]:
        """Plain values; a missing text says so."""
        return {key: text or UNRECORDED for key, text in asdict(self).items()}


NO_CONSENT = "no consent recorded: if this is a real person's face, ask before you show it"


def origin_of(avatar: "Avatar") -> Origin:
    """What an opened avatar says about itself."""
    about = avatar.gem.about
    texts = {key: plain(about.get(key, "")).strip() for key in ("author", "licence", "consent", "source")}
    return Origin(plain(avatar.gem.name), avatar.sha256, **texts)


def plain(text: str) -> str:
    """Text of unknown origin without what could steer a terminal."""
    shown = "".join(char if char.isprintable() else " " for char in text[:LONGEST_TEXT])
    return shown + "…" * (len(text) > LONGEST_TEXT)
