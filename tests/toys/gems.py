"""Small avatars: one to be looked through number by number, one that can be drawn, and one that never moves."""

from dataclasses import replace

import numpy as np
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing

_TINY = {"position": 3, "rotation": 2, "scale": 2, "opacity": 0}
SPLATS, COMPONENTS = 400, 6


def six_splats() -> Gem:
    """Six splats, of which the last two never move; all its numbers are small fractions, exact on every machine."""
    bases = {}
    for name in MODALITIES:
        count, width = _TINY[name], 6 * CHANNELS[name]
        mean = (np.arange(width) % 7 - 3) / 8
        components = (np.arange(count * width).reshape(count, width) * 5 % 11 - 5) / 16
        components[:, 4 * CHANNELS[name] :] = 0
        sigma = np.float32([0.5, 0.25, 0.125])[:count]
        bases[name] = Basis(np.concatenate([mean[None], components]).astype(np.float32), sigma)
    total = sum(_TINY.values())
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


def ball(seed: int = 0) -> Gem:
    """A ball of splats the size of a head, with orthonormal components and a map from ARKit weights."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(SPLATS, 3))
    positions = 0.1 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    means = {
        "position": positions,
        "rotation": np.tile([1.0, 0, 0, 0], (SPLATS, 1)),
        "scale": np.full((SPLATS, 3), np.log(0.008)),
        "opacity": np.full((SPLATS, 1), 3.0),
    }
    bases = {}
    for name in MODALITIES:
        width = SPLATS * CHANNELS[name]
        components = np.linalg.qr(rng.normal(size=(width, COMPONENTS)))[0].T
        rows = np.ascontiguousarray(np.vstack([means[name].reshape(1, -1), components]), np.float32)
        bases[name] = Basis(rows, np.linspace(0.05, 0.02, COMPONENTS, dtype=np.float32))
    return Gem(
        name="tiny",
        bases=bases,
        colors=rng.uniform(0.2, 0.9, (SPLATS, 3)).astype(np.float32),
        neck_weights=np.ones(SPLATS, np.float32),
        neck_pivot=np.array([0, -0.1, 0], np.float32),
        uv_index=np.stack([np.arange(SPLATS) % 64, np.arange(SPLATS) // 64], 1).astype(np.uint16),
        uv_size=64,
        viewing=Viewing((0.0, 0.0, 0.0), 0.2),
        arkit_weights=rng.normal(0, 0.01, (52, 4 * COMPONENTS)).astype(np.float32),
        about={"author": "test", "licence": "CC0", "consent": "synthetic", "source": "random numbers"},
    )


def statue() -> Gem:
    """The ball without any component, as a single frame is distilled."""
    return replace(ball().truncated(0), arkit_weights=None)
