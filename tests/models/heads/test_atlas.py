"""One texel a splat."""

import numpy as np
import pytest
from gemheads.models.heads.atlas import lay_out


def test_no_texel_twice_and_none_outside() -> None:
    rng = np.random.default_rng(1)
    part = np.repeat([0, 1, 5], [700, 90, 150])
    texels = lay_out(rng.normal(size=(940, 3)), part, 32)
    assert texels.max() < 32
    assert len(np.unique(texels, axis=0)) == 940


def test_neighbours_stay_neighbours() -> None:
    y, angle = np.mgrid[-1:1:40j, -1.4:1.4:40j]
    points = np.stack([0.09 * np.sin(angle), 0.1 * y, 0.09 * np.cos(angle) - 0.08], -1).reshape(-1, 3)
    texels = lay_out(points, np.zeros(1600, int), 40).astype(float)
    step = np.linalg.norm(texels[1:] - texels[:-1], axis=1).reshape(-1)[np.arange(1599) % 40 != 39]
    assert np.median(step) <= 1.5
    shuffled = np.random.default_rng(0).permutation(1600)
    assert np.median(np.linalg.norm(texels[shuffled][1:] - texels[shuffled][:-1], axis=1)) > 15


def test_too_many_splats_are_refused() -> None:
    with pytest.raises(ValueError, match="do not fit 4 x 4"):
        lay_out(np.zeros((17, 3)), np.zeros(17, int), 4)
