"""Equation 1 and what follows from it."""

from dataclasses import replace

import numpy as np
import pytest
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing
from gemheads.render.gaussians import RawGaussians

SPLATS, COMPONENTS = 40, 6


@pytest.fixture
def gem() -> Gem:
    """40 splats with six orthonormal components a modality."""
    rng = np.random.default_rng(3)
    bases = {}
    for name in MODALITIES:
        width = SPLATS * CHANNELS[name]
        components = np.linalg.qr(rng.normal(size=(width, COMPONENTS)))[0].T
        rows = np.concatenate([rng.normal(size=(1, width)), components]).astype(np.float32)
        bases[name] = Basis(np.ascontiguousarray(rows), np.linspace(2, 0.5, COMPONENTS).astype(np.float32))
    return Gem(
        name="random",
        bases=bases,
        colors=rng.random((SPLATS, 3), np.float32),
        neck_weights=np.ones(SPLATS, np.float32),
        neck_pivot=np.zeros(3, np.float32),
        uv_index=np.zeros((SPLATS, 2), np.uint16),
        uv_size=8,
        viewing=Viewing((0.0, 0.0, 0.0), 0.25),
    )


@pytest.fixture
def coefficients(gem: Gem) -> np.ndarray:
    return np.random.default_rng(5).normal(0, 1, gem.coefficient_count).astype(np.float32)


def parts(raw: RawGaussians) -> tuple[np.ndarray, ...]:
    return raw.positions, raw.wxyz, raw.log_scales, raw.opacity_logits


@pytest.mark.parametrize("used", [0, 1, 4, COMPONENTS, 99, None])
def test_compose_is_equation_1(gem: Gem, coefficients: np.ndarray, used: int | None) -> None:
    raw = gem.compose(coefficients, used)
    count = COMPONENTS if used is None else min(used, COMPONENTS)
    for name, values in zip(MODALITIES, parts(raw), strict=True):
        basis, k = gem.bases[name], coefficients[gem.slices[name]].astype(np.float64)
        wanted = basis.mean + sum(k[i] * basis.components[i].astype(np.float64) for i in range(count))
        np.testing.assert_allclose(values.reshape(-1), wanted, atol=2e-6)
    assert raw.colors is gem.colors


def test_compose_overwrites_what_it_is_given(gem: Gem, coefficients: np.ndarray) -> None:
    out = gem.compose(coefficients)
    kept = [values.copy() for values in parts(out)]
    again = gem.compose(-coefficients, out=out)
    assert again is out
    assert not np.allclose(out.positions, kept[0])
    gem.compose(coefficients, out=out)
    for values, before in zip(parts(out), kept, strict=True):
        np.testing.assert_array_equal(values, before)


def test_composing_fewer_components_leaves_no_trace(gem: Gem, coefficients: np.ndarray) -> None:
    wanted = [values.copy() for values in parts(gem.compose(coefficients, 6))]
    gem.compose(9 * coefficients, 2)
    for values, before in zip(parts(gem.compose(coefficients, 6)), wanted, strict=True):
        np.testing.assert_array_equal(values, before)


def test_project_undoes_compose(gem: Gem, coefficients: np.ndarray) -> None:
    np.testing.assert_allclose(gem.project(gem.compose(coefficients)), coefficients, atol=1e-5)


def test_project_takes_either_sign_of_a_quaternion(gem: Gem, coefficients: np.ndarray) -> None:
    raw = gem.compose(coefficients)
    raw.wxyz[::2] *= -1
    np.testing.assert_allclose(gem.project(raw), coefficients, atol=1e-5)


def test_truncated_composes_the_same(gem: Gem, coefficients: np.ndarray) -> None:
    gem = replace(
        gem, rest=coefficients, arkit_weights=np.ones((52, gem.coefficient_count), np.float32), regressor=b"x"
    )
    short = gem.truncated(2)
    assert short.coefficient_count == 8
    assert short.components == 2
    assert short.regressor is None
    for values, wanted in zip(
        parts(short.compose(short.rest_coefficients)), parts(gem.compose(coefficients, 2)), strict=True
    ):
        np.testing.assert_allclose(values, wanted, atol=1e-6)
    assert short.arkit_coefficients(np.ones(52)).shape == (8,)


def test_clamped_stays_within_three_sigma(gem: Gem) -> None:
    far = np.full((2, gem.coefficient_count), 100.0)
    np.testing.assert_array_equal(gem.clamped(far)[0], 3 * gem.sigma)
    np.testing.assert_array_equal(gem.clamped(-far)[1], -3 * gem.sigma)
    small = gem.sigma / 2
    np.testing.assert_array_equal(gem.clamped(small), small)


def test_swept_moves_one_component(gem: Gem) -> None:
    rows = gem.swept("scale", 3, 5)
    index = gem.slices["scale"].start + 3
    np.testing.assert_allclose(rows[:, index], np.array([-3, -1.5, 0, 1.5, 3]) * gem.sigma[index], rtol=1e-6)
    assert not np.delete(rows, index, axis=1).any()
    with pytest.raises(ValueError, match="6 scale components, not 7"):
        gem.swept("scale", 6, 5)


def test_arkit_weights_add_to_the_rest(tiny_gem: Gem) -> None:
    assert tiny_gem.arkit_weights is not None
    np.testing.assert_array_equal(tiny_gem.arkit_coefficients(np.zeros(52)), tiny_gem.rest)
    both = tiny_gem.arkit_coefficients(np.eye(52)[[4, 9]])
    np.testing.assert_allclose(both, tiny_gem.rest_coefficients + tiny_gem.arkit_weights[[4, 9]])
    with pytest.raises(ValueError, match="'Tiny' has no ARKit map"):
        replace(tiny_gem, arkit_weights=None).arkit_coefficients(np.zeros(52))


def test_coefficients_of_another_length_are_refused(gem: Gem) -> None:
    with pytest.raises(ValueError, match=r"'random' has 24 coefficients, got \(23,\)"):
        gem.compose(np.zeros(23, np.float32))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"neck_weights": np.zeros(5, np.float32)}, r"neck_weights must have the shape \(6,\)"),
        ({"rest": np.zeros(6, np.float32)}, r"rest must have the shape \(7,\)"),
        ({"arkit_weights": np.zeros((51, 7), np.float32)}, r"arkit_weights must have the shape \(52, 7\)"),
        ({"bases": {}}, "an avatar has the bases"),
    ],
)
def test_parts_that_do_not_fit_are_refused(tiny_gem: Gem, change: dict, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        replace(tiny_gem, **change)


def test_a_basis_of_another_head_is_refused(tiny_gem: Gem) -> None:
    other = Basis(np.zeros((4, 21), np.float32), np.ones(3, np.float32))
    with pytest.raises(ValueError, match="position basis is 21 wide, 6 splats need 18"):
        replace(tiny_gem, bases={**tiny_gem.bases, "position": other})


@pytest.mark.parametrize("rows", [np.zeros((2, 6)), np.zeros(6, np.float32), np.zeros((6, 2), np.float32).T])
def test_rows_that_are_no_matrix_are_refused(rows: np.ndarray) -> None:
    with pytest.raises(ValueError, match="contiguous float32 matrix"):
        Basis(rows, np.ones(1, np.float32))


@pytest.mark.parametrize("sigma", [[0.0], [-1.0], [np.nan], [], [1.0, 1.0]])
def test_sigmas_that_are_none_are_refused(sigma: list[float]) -> None:
    with pytest.raises(ValueError, match="that many sigmas > 0"):
        Basis(np.zeros((2, 6), np.float32), np.float32(sigma))


def test_where_most_stands_still_only_the_rest_is_kept_twice(gem: Gem) -> None:
    dense = gem.bases["position"]
    rows = dense.rows.copy()
    rows[1:, 3:] = 0
    sparse = Basis(rows, dense.sigma)
    assert dense.moving is None
    assert dense.nbytes == dense.rows.nbytes
    assert sparse.moving is not None
    np.testing.assert_array_equal(sparse.moving.columns, [0, 1, 2])
    assert sparse.nbytes == rows.nbytes + 3 * 4 + 3 * len(sparse) * 4
    coefficients = np.arange(1, len(sparse) + 1, dtype=np.float32)
    out = np.full(rows.shape[1], np.nan, np.float32)
    sparse.compose(coefficients, out)
    np.testing.assert_allclose(out, rows[0] + coefficients @ rows[1:], atol=1e-5)
    np.testing.assert_allclose(sparse.correlate(out), rows[1:] @ out, atol=1e-5)
