"""What several commands take alike."""

from typing import Annotated, Literal

from cyclopts import Parameter

Out = Annotated[str, Parameter(name=["--out", "-o"])]
AvatarName = Annotated[str | None, Parameter(name="--avatar")]
Size = Annotated[str, Parameter(name="--size")]
EngineName = Literal["auto", "quads", "software"]
NoBadge = Annotated[str | None, Parameter(name="--no-badge")]
DriverName = Literal["learned", "baseline"]
