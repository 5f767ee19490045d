"""Smiles push cheeks out and up, away from the fold beside the mouth."""

import numpy as np
from gemheads.models.heads.cheeks import fold_at, lifted

FORWARD = np.array([0.0, 0.0, 1.0])


def moved(x_mm: float, y_mm: float, z_mm: float = 0.0) -> np.ndarray:
    return lifted(np.array([[x_mm, y_mm, z_mm]]) * 1e-3, FORWARD[None])[0] * 1e3


def test_the_cheek_stands_out_and_rises_and_the_fold_beside_it_deepens() -> None:
    cheek, fold = moved(38, -45), moved(fold_at(np.array(-50.0)), -50)
    assert cheek[2] > 2.5
    assert cheek[1] > 1
    assert fold[2] < -0.5
    np.testing.assert_allclose(moved(-38, -45), cheek)  # there is no push to either side where skin looks forward


def test_nothing_else_moves() -> None:
    for x, y, z in ((0, 0, 0), (0, -70, 0), (0, -100, 0), (30, 50, 0), (31, 0, 0), (38, -45, -80)):
        assert np.abs(moved(x, y, z)).max() < 0.15, (x, y, z)
