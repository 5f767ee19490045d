"""Commands about this machine: bench and doctor."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import ExitCode, UsageError
from .options import AvatarName

LONGEST_SECS = 3600


def bench(
    *,
    avatar: AvatarName = None,
    json: Path | None = None,
    quick: Annotated[bool, Parameter(negative="")] = False,
    live: Annotated[bool, Parameter(negative="")] = False,
    seconds: float | None = None,
) -> int:
    """Measure drawing on this machine: median milliseconds by stage and frames per second.

    Args:
        avatar: Name of an avatar or a .gem file to measure besides the synthetic scenes.
        json: Also write the figures as JSON.
        quick: Only the smallest scene.
        live: Measure the live window instead: pictures a second, and latency read from the screen's pixels.
        seconds: How long to measure the live window. Default: 20.
    """
    if live:
        from ..bench.live import run_live_bench

        lasting = 20.0 if seconds is None else seconds
        if quick:
            raise UsageError("--quick: the live window has no scenes; leave it out with --live")
        if not 1 <= lasting <= LONGEST_SECS:
            raise UsageError(f"--seconds {lasting:g}: choose from 1 to {LONGEST_SECS}")
        run_live_bench(seconds=lasting, json=json, avatar=avatar)
        return ExitCode.OK
    if seconds is not None:
        raise UsageError("--seconds is how long --live measures; give that, too")
    from ..bench.drawing import run_bench

    run_bench(json=json, quick=quick, avatar=avatar)
    return ExitCode.OK


def doctor() -> int:
    """Check what works on this machine, with the cure for what does not."""
    from ..doctor import run_doctor

    return run_doctor()
