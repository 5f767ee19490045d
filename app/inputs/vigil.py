"""Watching over a camera: does it still send pictures, and do they still change?"""

import zlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

STALE_SECS = 1.0
"""A camera that sends nothing for so long has stalled ..."""
FIRST_SECS = 5.0
"""... but before its first picture it may take this long to wake up."""
GONE_SECS = 0.8
"""A camera that answers that it has nothing for so long was unplugged: that is known before it counts as stalled."""
MOST_SAME = 15
"""So many pictures in a row, all the same to the last bit: no sensor does that, its driver hangs."""
_EVERY = 7
"""Pixels between two that are compared, along both sides."""


@dataclass(frozen=True)
class Vigil:
    """What is known of the pictures so far."""

    since: float
    """When the last picture came, or the source was opened; seconds of the loop's clock."""
    first: bool = True
    """Whether no picture came yet."""
    digest: int = -1
    same: int = 0
    """Pictures in a row that are like the last one, that one included."""

    @property
    def frozen(self) -> bool:
        """Whether the same picture comes over and over."""
        return self.same >= MOST_SAME

    def stale(self, now: float) -> bool:
        """Whether nothing has come for too long."""
        return now - self.since > (FIRST_SECS if self.first else STALE_SECS)


def watch(before: Vigil, rgb: NDArray[np.uint8], now: float) -> Vigil:
    """The vigil after a picture [H, W, 3]."""
    digest = zlib.crc32(rgb[::_EVERY, ::_EVERY].tobytes(), rgb.shape[0] << 16 | rgb.shape[1])
    same = before.same + 1 if digest == before.digest else 1
    return replace(before, since=now, first=False, digest=digest, same=same)
