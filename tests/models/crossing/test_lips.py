"""Lips that part, and lips that stay shut."""

import numpy as np
import pytest
from gemheads.models.crossing.lips import PARTED_MM, lips
from gemheads.models.crossing.reading import Reading, Readings
from gemheads.models.driver.features import BLOCKS, DIMENSION
from gemheads.models.driver.measures import MEASURES


def mouths(gaps: list[float]) -> Readings:
    """Faces that do nothing but stand their lips apart, in centimetres."""
    features = np.zeros((len(gaps), DIMENSION), "f4")
    features[:, BLOCKS["measures"].start + MEASURES.index("lip_gap")] = gaps
    return Readings(features, np.zeros((len(gaps), 3)), np.zeros((len(gaps), 6)), np.zeros((len(gaps), 512), "f4"))


def at_rest(gap: float) -> Reading:
    return mouths([gap])[0]


def test_lips_count_against_their_own_rest() -> None:
    found = lips(mouths([0.1, 0.6, 1.1]), at_rest(0.1), mouths([0.2, 0.7, 1.2]), at_rest(0.2))
    assert found.off_mm == pytest.approx(0, abs=1e-5)
    assert found.shut == 0


def test_a_mouth_that_stays_shut_until_it_is_wide_is_told() -> None:
    parted = PARTED_MM / 10 + 0.1
    driver = mouths([0.0, parted, parted, 1.0, 1.2])
    avatar = mouths([0.0, 0.0, parted - 0.1, 1.0, 1.2])
    found = lips(driver, at_rest(0), avatar, at_rest(0))
    assert found.shut == pytest.approx(1 / 4)
    assert found.off_mm == pytest.approx(10 * np.sqrt((0.4**2 + 0.1**2) / 5), rel=1e-5)


def test_whose_lips_never_part_and_who_is_never_seen() -> None:
    still = lips(mouths([0.0, 0.1]), at_rest(0), mouths([0.0, 0.1]), at_rest(0))
    assert np.isnan(still.shut)
    assert still.off_mm == 0
    nobody = lips(mouths([]), at_rest(0), mouths([]), at_rest(0))
    assert np.isnan(nobody.off_mm)
    assert np.isnan(nobody.shut)
