"""The sum in equation 1 against NumPy, at block and remainder edges."""

import numpy as np
import pytest
from gemheads.models.blend import blend


@pytest.mark.parametrize("width", [1, 4095, 4096, 4097, 10_001])
@pytest.mark.parametrize("used", [1, 2, 4, 5, 6, 12])
def test_it_is_the_product(width: int, used: int) -> None:
    rng = np.random.default_rng(width + used)
    rows = rng.normal(size=(12, width)).astype(np.float32)
    rows[used:] = np.nan  # never read
    weights = rng.normal(size=used).astype(np.float32)
    out = np.full(width + 2, 7, np.float32)
    blend(weights, rows, out[1:-1])
    np.testing.assert_allclose(out[1:-1], weights.astype(float) @ rows[:used].astype(float), rtol=0, atol=2e-5)
    assert out[0] == out[-1] == 7
