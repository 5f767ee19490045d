"""What every importer gives: frames of splats in the canonical space, and what else a GEM needs."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.gaussians import RawGaussians
from ..gem import Viewing


@dataclass(frozen=True)
class Source:
    """Somebody else's avatar, ready to be distilled."""

    kind: str
    """What it is, for people: "LAM avatar", "sequence of PLY files"."""
    splats: int
    """N."""
    count: int
    """F, how many frames ``frames`` gives."""
    frames: Callable[[], Iterator[RawGaussians]]
    """Gives all frames from the first, each time it is called; metres, y up, looking along +z, the head held still."""
    rest: RawGaussians
    """The neutral expression."""
    neck_weights: NDArray[np.float32]
    """[N] share of the head's pose, 0..1."""
    neck_pivot: NDArray[np.float32]
    """[3] the point the head turns about, metres."""
    viewing: Viewing
    performance: NDArray[np.float32] | None = None
    """[F, 52] the ARKit weights of each frame, where the avatar is driven by such."""
    notes: tuple[str, ...] = ()
    """What its owner should know about how it was read."""
    uv_index: NDArray[np.uint16] | None = None
    """[N, 2] column and row of each splat in a UV map, where the splats have such."""
    uv_size: int = 0
    """Side of that map."""
    moments: tuple[int, ...] = ()
    """[F] timestep of each frame, where they come from a capture."""
