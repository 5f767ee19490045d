"""Colours, sizes and rates as people type them."""

import re
from fractions import Fraction

from .errors import UsageError

NAMED = {
    "black": (0.0, 0.0, 0.0),
    "white": (1.0, 1.0, 1.0),
    "grey": (0.75, 0.75, 0.75),
    "gray": (0.75, 0.75, 0.75),
    "green": (0.0, 0.694, 0.251),
    "blue": (0.0, 0.278, 0.733),
}
"""green and blue are the chroma-key screens."""
LARGEST_SIDE = 4096
FINEST_RATE = 10_000
"""Greatest denominator of a rate; that of television is 1001. Times in finer units are beyond what containers hold."""


def read_colour(text: str) -> tuple[float, float, float] | None:
    """sRGB in [0, 1] of a name or #rrggbb; None for ``transparent``. Raises UsageError."""
    word = text.strip().lower()
    if word == "transparent":
        return None
    if word in NAMED:
        return NAMED[word]
    if match := re.fullmatch(r"#?([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})", word):
        red, green, blue = (int(part, 16) / 255 for part in match.groups())
        return red, green, blue
    raise UsageError(f"--background {text}: not a colour; use #rrggbb, transparent, or {', '.join(NAMED)}")


def read_size(text: str) -> tuple[int, int]:
    """Width and height in pixels of WxH; both even, as video wants them. Raises UsageError."""
    match = re.fullmatch(r"(\d{1,5})[xX×](\d{1,5})", text.strip())
    if not match:
        raise UsageError(f"--size {text}: not a size; use WIDTHxHEIGHT in pixels, such as 512x512")
    width, height = int(match[1]), int(match[2])
    if not all(16 <= side <= LARGEST_SIDE and side % 2 == 0 for side in (width, height)):
        raise UsageError(f"--size {text}: both sides must be even and from 16 to {LARGEST_SIDE}, such as 512x512")
    return width, height


def read_rate(text: str) -> Fraction:
    """Frames per second of ``25`` or ``30000/1001``. Raises UsageError."""
    try:
        rate = Fraction(text).limit_denominator(FINEST_RATE)
    except (ValueError, ZeroDivisionError):
        rate = Fraction(0)
    if not 0 < rate <= 1000:
        raise UsageError(f"--rate {text}: not a rate; use frames per second such as 25 or 30000/1001")
    return rate


def refuse(what: str, **options: object) -> None:
    """Raises UsageError for the first option that was given, not None, though it does nothing for ``what``."""
    for name, value in options.items():
        if value is not None:
            raise UsageError(f"--{name.replace('_', '-')}: does nothing for {what}; leave it out")
