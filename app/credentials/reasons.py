"""Why a result carries no badge: only with a reason in words, which stays with the result."""

from ..errors import UsageError
from .origin import plain

SHORTEST, LONGEST = 10, 300
"""Characters."""
EXAMPLE = "the whole channel is labelled as computer-made"


def read_reason(text: str | None) -> str:
    """The reason of ``--no-badge``; empty for None, which keeps the badge. Raises UsageError when it is none."""
    if text is None:
        return ""
    reason = " ".join(plain(text).split())
    if not is_reason(reason):
        raise UsageError(
            f"--no-badge {text!r}: say why, in {SHORTEST} to {LONGEST} characters, such as {EXAMPLE!r};"
            " it goes into the report and into the credentials"
        )
    return reason


def is_reason(text: str) -> bool:
    """Whether a text can stand as a reason."""
    return SHORTEST <= len(text) <= LONGEST
