"""Whether an avatar looks like the pictures of a capture at all."""

import sys
from pathlib import Path

UNLIKE_DB = 14.0
"""Somebody else's avatar came to 12 dB, the right one before cameras of other axes to 6, a bare mesh of one's own to
20."""


def tell_of_unlikeness(avatar: Path, capture: Path, decibels: float) -> None:
    """A line on stderr where an avatar differs so much from a capture's pictures that something must be wrong."""
    if decibels < UNLIKE_DB:
        print(
            f"{avatar}: at {decibels:.1f} dB it does not look like the pictures of {capture}: it is of somebody else,"
            " or the cameras (OpenGL axes, camera to world) and meshes of the capture do not belong together",
            file=sys.stderr,
        )
