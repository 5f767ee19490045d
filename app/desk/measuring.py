"""The compression curve of an avatar, measured while the window goes on."""

import threading
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...models.gem import MODALITIES, Gem
from ...render.software import SoftwareEngine
from ..live import NO_SHIFT, Stage, draw
from ..performing.mailbox import Mailbox
from ..performing.performance import Pose
from ..performing.portrait import portrait
from ..performing.timing import Stopwatch
from .compare import decibels
from .painter import KERNELS
from .view import Curve

COUNTS = (1, 2, 3, 5, 8, 12, 16, 20, 25, 30, 40, 50, 75, 100, 150, 200, 300, 512)
SIZE = 256
POSES = 4
"""Expressions that each count is measured on, besides the one at rest."""
GREY = (0.75, 0.75, 0.75)
BYTES = 4
"""Of a number of a basis in memory."""


def megabytes(gem: Gem, components: int) -> float:
    """Memory of the bases with so many components a modality, in MB, mean included."""
    numbers = sum(gem.bases[name].rows.shape[1] * (min(components, len(gem.bases[name])) + 1) for name in MODALITIES)
    return numbers * BYTES / 1e6


def counts_of(gem: Gem) -> tuple[int, ...]:
    """At which counts an avatar is measured: up to all that it stores."""
    return (*(count for count in COUNTS if count < gem.components), gem.components)


def curve_of(gem: Gem, ended: Callable[[], bool] = lambda: False) -> Curve | None:
    """PSNR against all components, over expressions drawn from the avatar's own spread (one sigma, always the same).

    Drawing takes the lock of the window's engine for one picture at a time. None when ``ended`` says so in between.
    """
    spread = np.random.default_rng(0).normal(size=(POSES, gem.coefficient_count)).astype(np.float32)
    vectors = [gem.rest_coefficients, *(gem.clamped(row * gem.sigma) for row in spread)]
    poses = [Pose(vector, NO_SHIFT) for vector in vectors]
    # splats of its own: those of the window are being drawn
    engine = SoftwareEngine()
    engine.warm()  # compiled before the lock is taken: the window draws with quads meanwhile
    stage = Stage(gem, engine, portrait(gem.viewing, SIZE, SIZE), GREY, Stopwatch())
    wholes = [_drawn(stage, pose) for pose in poses]
    counts = counts_of(gem)
    quality = []
    for count in counts:
        fewer = replace(stage, components=count)
        squares = []
        for whole, pose in zip(wholes, poses, strict=True):
            if ended():
                return None
            squares.append(10 ** (-decibels(whole, _drawn(fewer, pose)) / 10))
        quality.append(-10 * np.log10(np.mean(squares)))
    sizes = [megabytes(gem, count) for count in counts]
    return Curve(np.array(counts, float), np.array(sizes), np.array(quality))


def _drawn(stage: Stage, pose: Pose) -> np.ndarray:
    with KERNELS:
        return draw(stage, pose).copy()


class Measuring:
    """Measures avatars in a thread, one behind the other; keeps what it measured."""

    def __init__(self) -> None:
        self._wanted: Mailbox[tuple[str, Gem] | None] = Mailbox()
        self._ended = threading.Event()
        self._curves: dict[str, Curve] = {}
        self._asked = ""
        threading.Thread(target=self._run, name="curve", daemon=True).start()

    def curve(self, sha256: str, gem: Gem) -> Curve | None:
        """The curve of an avatar; None until it is there. Asking begins the measuring."""
        if sha256 not in self._curves and self._asked != sha256:
            self._asked = sha256
            self._wanted.put((sha256, gem))
        return self._curves.get(sha256)

    def close(self) -> None:
        """End the thread, after at most one more picture."""
        self._ended.set()
        self._wanted.put(None)

    def _run(self) -> None:
        while not self._ended.is_set():
            wanted = self._wanted.take(timeout=3600.0)
            if wanted is not None and (curve := curve_of(wanted[1], ended=self._ended.is_set)) is not None:
                self._curves[wanted[0]] = curve
