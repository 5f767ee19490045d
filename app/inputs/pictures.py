"""Pictures as a source: a folder, a numbered sequence, or one picture that stays."""

import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..files.frames import Frame
from ..files.sources import Images, open_source, read_image
from .player import Player
from .source import Delivery


def open_pictures(path: Path, rate: float = 30.0, clock: Callable[[], float] = time.perf_counter) -> Player:
    """A folder of pictures, a numbered sequence or one picture, at ``rate`` a second. Raises InputError."""
    source = open_source(str(path), Fraction(rate).limit_denominator(1000))
    if not isinstance(source, Images):
        raise InputError(f"{path}: neither a picture nor a folder of pictures; open it as a video")
    files, tick = source.files, source.time_base

    def deliver(index: int, seconds: float) -> Delivery:
        return Frame(read_image(files[index]), index, tick)

    return Player(path.name, "pictures", np.arange(len(files), dtype=np.float64) * float(tick), deliver, clock)
