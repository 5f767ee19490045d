"""An avatar of a few random splats, for tests that draw nothing."""

import numpy as np
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing


def toy_gem(rigged: bool = True, splats: int = 12, components: int = 5) -> Gem:
    """Steered by ARKit weights where ``rigged``, else by its coefficients."""
    rng = np.random.default_rng(0)
    bases = {
        name: Basis(
            rng.normal(size=(components + 1, splats * CHANNELS[name])).astype("f4"),
            np.linspace(1, 0.2, components).astype("f4"),
        )
        for name in MODALITIES
    }
    count = 4 * components
    return Gem(
        "toy",
        bases,
        np.full((splats, 3), 0.5, "f4"),
        np.ones(splats, "f4"),
        np.zeros(3, "f4"),
        np.zeros((splats, 2), "u2"),
        8,
        Viewing((0, 0, 0), 0.25),
        arkit_weights=rng.normal(size=(52, count)).astype("f4") if rigged else None,
    )
