import tracemalloc

import numpy as np
import pytest
from gemheads.app.performing.figures import WINDOW, Figures, Ring, Spread


def test_a_ring_keeps_the_last_and_forgets_the_rest() -> None:
    ring = Ring(4)
    assert ring.spread() == Spread(0.0, 0.0)
    for value in (9.0, 9.0, 1.0, 2.0, 3.0, 4.0):
        ring.add(value)
    assert sorted(ring.values) == [1.0, 2.0, 3.0, 4.0]
    assert ring.spread(1.0).median == 2.5


def test_pictures_a_second_are_those_of_the_last_two_seconds() -> None:
    figures = Figures()
    for number in range(60):  # two seconds at 30
        figures.shown(number / 30, None)
    assert figures.view(59 / 30).fps == pytest.approx(30.0, rel=0.02)
    for number in range(50):  # then at 12.5
        figures.shown(2.0 + number * 0.08, None)
    assert figures.view(2.0 + 49 * 0.08).fps == pytest.approx(12.5, rel=0.02)
    assert figures.view(100.0).fps == 0.0  # nothing was shown for long


def test_latency_counts_new_frames_only() -> None:
    figures = Figures()
    assert figures.view(0.0).latency is None
    for number in range(100):
        now = number / 60
        figures.shown(now, now - 0.040 if number % 2 == 0 else None)
    latency = figures.view(2.0).latency
    assert latency is not None
    assert latency.median == pytest.approx(40.0)
    assert latency.p95 == pytest.approx(40.0)


def test_stages_have_their_median_and_their_worst() -> None:
    figures = Figures()
    rng = np.random.default_rng(0)
    times = rng.uniform(0.001, 0.003, WINDOW)
    for secs in times:
        figures.stage("draw", float(secs))
    figures.stage("panels", 0.0005)
    with figures.timed("swap"):
        pass
    stages = figures.view(0.0).stages
    assert list(stages) == ["draw", "panels", "swap"]
    assert stages["draw"].median == pytest.approx(1e3 * np.median(times))
    assert stages["draw"].p95 == pytest.approx(1e3 * np.quantile(times, 0.95))
    assert stages["panels"] == Spread(0.5, 0.5)


def test_a_stage_that_fails_is_timed_too() -> None:
    figures = Figures()
    with pytest.raises(KeyError), figures.timed("draw"):
        raise KeyError
    assert "draw" in figures.view(0.0).stages


def test_the_memory_is_that_of_this_process() -> None:
    assert 20 < Figures().view(0.0).rss_mb < 100_000


def test_a_long_session_takes_no_more_memory() -> None:
    figures = Figures()

    def a_minute(start: float) -> None:
        for number in range(1800):
            figures.stage("draw", 0.01)
            figures.shown(start + number / 30, start)
        figures.view(start + 60)

    a_minute(0.0)
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    a_minute(60.0)
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < 4096
