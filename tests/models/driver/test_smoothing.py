"""One-Euro against the published algorithm, value by value."""

import math

import numpy as np
import pytest
from gemheads.models.driver.smoothing import OneEuro, Smoothed, step


def published(settings: OneEuro, values: list[float], dts: list[float]) -> list[float]:
    """Algorithm 1 of Casiez et al. 2012 for one value, word for word."""
    answers = [values[0]]
    speed = 0.0
    for value, dt in zip(values[1:], dts, strict=True):
        edx = (value - answers[-1]) / dt
        a = 1 / (1 + 1 / (2 * math.pi * settings.derivative_cutoff_hz) / dt)
        speed = a * edx + (1 - a) * speed
        cutoff = settings.min_cutoff_hz + settings.beta * abs(speed)
        a = 1 / (1 + 1 / (2 * math.pi * cutoff) / dt)
        answers.append(a * value + (1 - a) * answers[-1])
    return answers


def run(settings: OneEuro, values: np.ndarray, dts: list[float]) -> np.ndarray:
    state: Smoothed | None = None
    answers = []
    for value, dt in zip(values, [0.0, *dts], strict=True):
        state = step(settings, state, value, dt)
        answers.append(state.value)
    return np.array(answers)


def test_it_is_the_published_filter_for_every_value() -> None:
    rng = np.random.default_rng(3)
    values, dts = rng.normal(size=(60, 5)).cumsum(0), list(rng.uniform(0.01, 0.08, 59))
    settings = OneEuro(min_cutoff_hz=0.8, beta=0.4, derivative_cutoff_hz=1.3)
    answers = run(settings, values, dts)
    for column in range(5):
        np.testing.assert_allclose(answers[:, column], published(settings, list(values[:, column]), dts), atol=1e-12)


def test_it_is_the_filter_of_the_package() -> None:
    package = pytest.importorskip("OneEuroFilter")
    values = np.sin(np.arange(80) / 9) + np.random.default_rng(4).normal(0, 0.05, 80)
    oracle = package.OneEuroFilter(freq=30, mincutoff=1.0, beta=0.5, dcutoff=1.0)
    expected = [oracle(value, i / 30) for i, value in enumerate(values)]
    answers = run(OneEuro(1.0, 0.5, 1.0), values[:, None], [1 / 30] * 79)
    np.testing.assert_allclose(answers[:, 0], expected, atol=1e-9)


def test_it_calms_noise_and_keeps_up_with_a_jump() -> None:
    rng = np.random.default_rng(5)
    values = np.r_[np.zeros(100), np.full(100, 10.0)][:, None] + rng.normal(0, 0.05, (200, 1))
    answers = run(OneEuro(1.0, 1.0), values, [1 / 30] * 199)
    assert answers[30:100].std() < 0.5 * values[30:100].std()
    assert answers[103] > 9


def test_a_seek_backwards_takes_the_value_as_it_is() -> None:
    settings = OneEuro()
    state = step(settings, None, np.array([1.0]), 0.0)
    assert step(settings, state, np.array([5.0]), -2.0).value[0] == 5


@pytest.mark.parametrize("settings", [{"min_cutoff_hz": 0}, {"beta": -1}, {"derivative_cutoff_hz": -1}])
def test_settings_without_sense_are_refused(settings: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="One-Euro"):
        OneEuro(**settings)
