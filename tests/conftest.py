"""Small avatars for tests of every room."""

import numpy as np
import pytest
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing

TINY_COMPONENTS = {"position": 3, "rotation": 2, "scale": 2, "opacity": 0}


@pytest.fixture
def tiny_gem() -> Gem:
    """Six splats, of which the last two never move; all its numbers are small fractions, exact on every machine."""
    bases = {}
    for name in MODALITIES:
        count, width = TINY_COMPONENTS[name], 6 * CHANNELS[name]
        mean = (np.arange(width) % 7 - 3) / 8
        components = (np.arange(count * width).reshape(count, width) * 5 % 11 - 5) / 16
        components[:, 4 * CHANNELS[name] :] = 0
        sigma = np.float32([0.5, 0.25, 0.125])[:count]
        bases[name] = Basis(np.concatenate([mean[None], components]).astype(np.float32), sigma)
    total = sum(TINY_COMPONENTS.values())
    return Gem(
        name="Tiny",
        bases=bases,
        colors=(np.arange(18).reshape(6, 3) / 32).astype(np.float32),
        neck_weights=np.float32([1, 1, 1, 0.5, 0.25, 0]),
        neck_pivot=np.float32([0, -0.125, -0.0625]),
        uv_index=np.arange(12, dtype=np.uint16).reshape(6, 2),
        uv_size=16,
        viewing=Viewing((0.0, 0.0625, 0.0), 0.25),
        arkit_weights=((np.arange(52 * total).reshape(52, total) % 5 - 2) / 4).astype(np.float32),
        rest=(np.arange(total) / 16).astype(np.float32),
        about={"author": "nobody", "licence": "CC0-1.0", "consent": "not a person", "source": "this test"},
    )
