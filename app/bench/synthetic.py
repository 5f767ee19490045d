"""A made-up avatar of any size, for measurements: dense like a head, with components of plain noise."""

import numpy as np
from numpy.typing import NDArray

from ...models.gem import MODALITIES, Basis, Gem, Viewing

RADII = np.array([0.075, 0.115, 0.095])
"""Half width, height and depth of a head, metres."""
_SPREAD = {"position": 3e-4, "rotation": 0.02, "scale": 0.02, "opacity": 0.05}
"""What one standard deviation of one component does to a number, in the raw units of its modality."""


def synthetic_gem(splats: int, components: int, rng: np.random.Generator) -> Gem:
    """``splats`` flat splats on an ellipsoid that they cover without holes, ``components`` in each modality."""
    directions = rng.standard_normal((splats, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    spacing = np.sqrt(4 * np.pi * np.prod(RADII) ** (2 / 3) / splats)
    means = {
        "position": directions * RADII,
        "rotation": rng.standard_normal((splats, 4)),
        "scale": np.log(spacing * np.array([0.8, 0.8, 0.4])) + 0.3 * rng.standard_normal((splats, 3)),
        "opacity": 2 + rng.standard_normal((splats, 1)),
    }
    return Gem(
        name="synthetic",
        bases={name: _basis(means[name], components, _SPREAD[name], rng) for name in MODALITIES},
        colors=rng.random((splats, 3), np.float32),
        neck_weights=np.ones(splats, np.float32),
        neck_pivot=np.zeros(3, np.float32),
        uv_index=np.zeros((splats, 2), np.uint16),
        uv_size=1,
        viewing=Viewing((0.0, 0.0, 0.0), 2 * float(RADII[1])),
    )


def _basis(mean: NDArray[np.float64], components: int, spread: float, rng: np.random.Generator) -> Basis:
    rows = np.empty((components + 1, mean.size), np.float32)
    rows[0] = mean.reshape(-1)
    rng.standard_normal(out=rows[1:], dtype=np.float32)
    rows[1:] *= spread
    return Basis(rows, np.ones(components, np.float32))
