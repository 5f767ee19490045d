"""Compiles what drawing needs and keeps it on disk, so that later the first picture comes at once."""

import time

from ..render.engines import open_engine
from .library import find_avatar
from .live import NO_SHIFT, Stage, draw
from .performing.casting import open_avatar
from .performing.performance import Pose
from .performing.portrait import portrait
from .performing.timing import Stopwatch
from .words import NAMED


def warm() -> float:
    """Draw one picture with the engine that needs compiling; returns the seconds it took."""
    started = time.perf_counter()
    gem = open_avatar(find_avatar()).gem
    engine = open_engine("software")
    try:
        stage = Stage(gem, engine, portrait(gem.viewing, 64, 64), NAMED["grey"], Stopwatch())
        draw(stage, Pose(gem.rest_coefficients, NO_SHIFT))
    finally:
        engine.close()
    return time.perf_counter() - started


if __name__ == "__main__":
    print(f"ready after {warm():.1f} s")
