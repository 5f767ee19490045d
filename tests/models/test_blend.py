"""The sum in equation 1 and its gradient against NumPy, at block and remainder edges."""

import numpy as np
import pytest
from gemheads.models.blend import blend, blend_columns, correlate

WIDTHS = pytest.mark.parametrize("width", [1, 4095, 4096, 4097, 10_001])
USED = pytest.mark.parametrize("used", [0, 1, 2, 4, 5, 6, 12])


def parts(width: int, used: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(width + used)
    rows = rng.normal(size=(12, width)).astype(np.float32)
    rows[used:] = np.nan  # never read
    return rng.normal(size=used).astype(np.float32), rng.normal(size=width).astype(np.float32), rows


@WIDTHS
@USED
def test_it_is_the_product(width: int, used: int) -> None:
    weights, mean, rows = parts(width, used)
    out = np.full(width + 2, 7, np.float32)
    blend(weights, mean, rows, out[1:-1])
    wanted = mean + weights.astype(float) @ rows[:used].astype(float)
    np.testing.assert_allclose(out[1:-1], wanted, rtol=0, atol=2e-5)
    assert out[0] == out[-1] == 7


@WIDTHS
@USED
def test_where_little_moves_the_rest_is_the_mean(width: int, used: int) -> None:
    weights, _, rows = parts(width, used)
    rng = np.random.default_rng(0)
    mean = rng.normal(size=3 * width).astype(np.float32)
    columns = np.sort(rng.permutation(3 * width)[:width]).astype(np.int32)
    out = np.full(3 * width + 2, 7, np.float32)
    blend_columns(weights, mean, rows, columns, out[1:-1])
    wanted = mean.astype(float)
    wanted[columns] += weights.astype(float) @ rows[:used].astype(float)
    np.testing.assert_allclose(out[1:-1], wanted, rtol=0, atol=2e-5)
    assert out[0] == out[-1] == 7


@WIDTHS
def test_back_through_it(width: int) -> None:
    _, values, rows = parts(width, 12)
    out = np.full(14, 7, np.float32)
    correlate(rows, values, out[1:-1])
    np.testing.assert_allclose(out[1:-1], rows.astype(float) @ values.astype(float), rtol=0, atol=1e-6 * width + 1e-5)
    assert out[0] == out[-1] == 7
