"""What ``gemheads verify`` says about a picture or a video: who signed it, whether it was changed, whose face it is."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..errors import ExitCode
from .localkey import NAME
from .origin import plain
from .reading import Verdict, read_credentials

CODES = {"intact": ExitCode.OK, "altered": ExitCode.ALTERED, "none": ExitCode.UNSIGNED}
STATES = {
    "intact": "intact: not a byte was changed since it was signed",
    "altered": "ALTERED: it is not what was signed",
    "none": "no credentials: nothing is said about it; they may never have been there, or were taken out",
}
MOST_AVATARS = 20
"""More are not listed."""
_SELF_SIGNED = "self-signed, so it proves that nothing was changed, not who made it"


def run_verify(path: Path) -> ExitCode:
    """Print the verdict on a file. Raises InputError, NoSignerError."""
    verdict = read_credentials(path)
    for label, text in lines(verdict):
        print(f"{label:12} {text}")
    return CODES[verdict.state]


def lines(verdict: Verdict) -> Iterator[tuple[str, str]]:
    """(label, text) of each line."""
    yield "State", STATES[verdict.state]
    yield from (("Because", problem) for problem in verdict.problems)
    if verdict.signer:
        yield "Signed by", _signer(verdict)
    if verdict.generator:
        yield "Made by", verdict.generator
    if verdict.source_type:
        yield "Source type", verdict.source_type
    if verdict.ours is not None:
        yield from _ours(verdict.ours)
    elif verdict.state != "none":
        yield "Avatar", "none is named: another program signed this"


def _signer(verdict: Verdict) -> str:
    if verdict.own:
        return f"the key of this computer ({_SELF_SIGNED})"
    if verdict.signer == NAME:
        return f"gemheads on another computer ({_SELF_SIGNED})"
    return f"{verdict.signer} (a name that nobody here has checked)"


def _ours(ours: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Every text comes from the file: it is shown plainly, whatever it is."""
    avatars = ours.get("avatars")
    for avatar in avatars[:MOST_AVATARS] if isinstance(avatars, list) else ():
        about = avatar if isinstance(avatar, dict) else {}
        for key in ("name", "licence", "consent"):
            yield ("Avatar" if key == "name" else key.capitalize()), _text(about.get(key))
    for key, label in (("driver", "Driver"), ("along", "Along")):
        if key == "driver" or key in ours:
            yield label, _driver(_table(ours, key))
    badge = _table(ours, "badge")
    yield "Badge", "drawn" if badge.get("drawn") is True else f"left out: {_text(badge.get('reason'))}"


def _driver(driver: Mapping[str, Any]) -> str:
    told = [_text(driver[key]) for key in ("kind", "name") if key in driver]
    told += [f"sha256 {_text(driver['sha256'])}"] if "sha256" in driver else []
    return ", ".join(told) or "not told"


def _table(ours: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = ours.get(key)
    return value if isinstance(value, dict) else {}


def _text(value: object) -> str:
    return plain(value) if isinstance(value, str) else "not told"
