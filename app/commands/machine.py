"""Commands about this machine: bench and doctor."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import ExitCode
from .options import AvatarName


def bench(
    *,
    avatar: AvatarName = None,
    json: Path | None = None,
    quick: Annotated[bool, Parameter(negative="")] = False,
    live: Annotated[bool, Parameter(negative="")] = False,
    seconds: float = 20.0,
) -> int:
    """Measure drawing on this machine: median milliseconds by stage and frames per second.

    Args:
        avatar: Name of an avatar or a .gem file to measure besides the synthetic scenes.
        json: Also write the figures as JSON.
        quick: Only the smallest scene.
        live: Measure the live window instead: pictures a second, and latency read from the screen's pixels.
        seconds: How long to measure the live window.
    """
    if live:
        from ..bench_live import run_live_bench

        run_live_bench(seconds=seconds, json=json, avatar=avatar)
        return ExitCode.OK
    from ..bench import run_bench

    run_bench(json=json, quick=quick, avatar=avatar)
    return ExitCode.OK


def doctor() -> int:
    """Check what works on this machine, with the cure for what does not."""
    from ..doctor import run_doctor

    return run_doctor()
