"""What is painted on the skin: its edges are as soft as they are meant to be."""

import numpy as np
from gemheads.models.heads.shading import blurred


def test_a_step_becomes_a_slope_as_wide_as_asked_for_and_flats_stay_flat() -> None:
    grid = np.stack(np.meshgrid(np.arange(-30, 31), np.arange(-30, 31), [0]), -1).reshape(-1, 3) * 1e-3
    step = (grid[:, 0] > 0).astype(float)
    soft = blurred(step, grid, sigma=4e-3)
    middle = np.abs(grid[:, 1]) < 15e-3
    for beside, share in ((0.5, 0.5), (4.5, 0.84), (-3.5, 0.16), (12.0, 1.0), (-12.0, 0.0)):
        at = middle & (np.abs(grid[:, 0] - beside * 1e-3) < 0.51e-3)
        assert abs(soft[at].mean() - share) < 0.04
    np.testing.assert_allclose(blurred(np.full(len(grid), 0.3), grid, 4e-3), 0.3)
