"""What the shape of a face makes its head seem to turn: raised brows tip a head that does not move, a smile lifts it.

Procrustes lays the canonical face on the landmarks as if it were rigid, so every expression moves the head pose a
little. How far is learned, linearly, from pictures of avatars whose heads turn by known angles
(``python -m gemheads.models.train.seeming``).
"""

import io
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .geometry import VERTICES

Floats = NDArray[np.floating]

MOST = np.radians(15.0)
"""About each axis no shape seems to turn a head further, radians: on six clips of people and five avatars the most is
11 degrees, of which up to 6 are the face's own and the same in its neutral."""


@dataclass(frozen=True)
class Seeming:
    """The turn that is read into the shape of a face."""

    mean: Floats
    """[468, 3] cm, the metric mesh that seems to turn nothing."""
    slopes: Floats
    """[3, 468, 3] radians about the canonical axes x, y, z for each cm."""

    def turn(self, metric_mesh: Floats) -> NDArray[np.float64]:
        """[3] rotation vector in the canonical frame, radians, of a metric mesh [468, 3] in cm: multiplied from the
        right it brings the head pose to where the head is."""
        away = (metric_mesh - self.mean).ravel()
        return np.clip(self.slopes.reshape(3, -1) @ away, -MOST, MOST).astype(np.float64)

    def packed(self) -> bytes:
        """As a file: NumPy's format, float32 [4, 468, 3], the mean before the slopes."""
        file = io.BytesIO()
        np.save(file, np.concatenate([self.mean[None], self.slopes]).astype("<f4"))
        return file.getvalue()


def read_seeming(content: bytes) -> Seeming:
    """What ``packed`` wrote. Raises ValueError when it is anything else."""
    try:
        table = np.load(io.BytesIO(content), allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise ValueError(f"seeming turn: {len(content)} bytes that are no plain table ({error})") from error
    if table.shape != (4, VERTICES, 3) or table.dtype != np.float32 or not np.isfinite(table).all():
        raise ValueError(
            f"seeming turn: {table.dtype} {list(table.shape)} instead of finite float32 [4, {VERTICES}, 3]"
        )
    return Seeming(table[0].astype(np.float64), table[1:].astype(np.float64))
