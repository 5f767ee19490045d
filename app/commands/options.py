"""What several commands take alike."""

from collections.abc import Sequence
from typing import Annotated, Literal

from cyclopts import Parameter, Token

from ...render.enginename import EngineName as EngineName


def _whole(kind: type, tokens: Sequence[Token]) -> int:
    """Cyclopts by itself rounds what has a point in it."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"'{tokens[0].value}' is not a whole number.") from None


def _seed(kind: type, tokens: Sequence[Token]) -> int:
    seed = _whole(kind, tokens)
    if not 0 <= seed <= GREATEST_SEED:
        raise ValueError(f"{seed}: choose from 0 to {GREATEST_SEED}.")
    return seed


GREATEST_SEED = 2**32 - 1
"""NumPy takes any, torch none beyond 64 bits, and says so after minutes; some are added to."""
Whole = Annotated[int, Parameter(converter=_whole)]
Seed = Annotated[int, Parameter(converter=_seed)]
Out = Annotated[str, Parameter(name=["--out", "-o"])]
AvatarName = Annotated[str | None, Parameter(name="--avatar")]
Size = Annotated[str, Parameter(name="--size")]
NoBadge = Annotated[str | None, Parameter(name="--no-badge")]
DriverName = Literal["learned", "baseline"]
