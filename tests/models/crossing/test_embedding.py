"""Cosine, L1 and Fréchet distance of embeddings."""

import numpy as np
import pytest
from gemheads.models.crossing.embedding import agreement, frechet
from scipy.linalg import sqrtm


def test_frechet_is_the_closed_form() -> None:
    rng = np.random.default_rng(1)
    one = rng.normal(size=(40, 6)) @ rng.normal(size=(6, 6))
    other = 0.5 + rng.normal(size=(70, 6)) @ rng.normal(size=(6, 6))
    a, b = np.cov(one.T), np.cov(other.T)
    wanted = ((one.mean(0) - other.mean(0)) ** 2).sum() + np.trace(a + b - 2 * sqrtm(a @ b).real)
    assert frechet(one, other) == pytest.approx(wanted, rel=1e-6)


def test_frechet_with_fewer_frames_than_values_is_no_less_exact() -> None:
    rng = np.random.default_rng(2)
    cloud = rng.normal(size=(5, 60))
    assert frechet(cloud, cloud) == pytest.approx(0, abs=1e-9)
    assert frechet(cloud, cloud + 2) == pytest.approx(4 * 60)
    assert frechet(cloud, 3 * cloud - 2 * cloud.mean(0)) == pytest.approx(4 * cloud.var(0, ddof=1).sum())


def test_the_same_agrees_and_chance_is_less() -> None:
    rng = np.random.default_rng(3)
    driver = rng.normal(size=(300, 12))
    same = agreement(driver, 2 * driver)
    assert same.cosine == pytest.approx(1)
    assert abs(same.chance) < 0.1
    assert same.l1 == pytest.approx(np.abs(driver).mean())
    other = agreement(driver, -driver)
    assert other.cosine == pytest.approx(-1)
    assert agreement(driver, np.zeros_like(driver)).cosine == 0
    constant = np.tile(driver[:1], (300, 1))
    assert agreement(constant, constant).chance == pytest.approx(1)


def test_the_drivers_own_neutral_has_no_direction_and_does_not_count() -> None:
    rng = np.random.default_rng(4)
    driver = rng.normal(size=(5, 12))
    avatar = driver + rng.normal(size=driver.shape)
    without = agreement(driver, avatar)
    rest = np.zeros((3, 12))
    for shown in (rest, rng.normal(size=rest.shape)):
        found = agreement(np.concatenate([driver, rest]), np.concatenate([avatar, shown]))
        assert found.cosine == pytest.approx(without.cosine)
        assert found.chance == pytest.approx(without.chance)
    assert agreement(np.concatenate([driver, driver]), np.concatenate([avatar, 0 * avatar])).cosine == pytest.approx(
        without.cosine / 2
    )
    assert agreement(rest, rest).cosine == agreement(rest, rest).chance == 0


def test_frames_have_to_be_the_same() -> None:
    with pytest.raises(ValueError, match="the same frames of both"):
        agreement(np.zeros((3, 4)), np.zeros((2, 4)))
    with pytest.raises(ValueError, match="the same frames of both"):
        agreement(np.zeros((0, 4)), np.zeros((0, 4)))
