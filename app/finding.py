"""What the doctor found of one thing."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One line of the doctor's report."""

    what: str
    works: bool
    detail: str
    cure: str = ""
    needed: bool = True
    """Whether reenactment is impossible without it."""
