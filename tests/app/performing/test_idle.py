import numpy as np
from gemheads.app.performing.idle import BLINK_EVERY_SECS, breath, lids_closed


def test_breathing_is_slow_and_small() -> None:
    angles = np.array([breath(t) for t in np.arange(0, 20, 0.04)])
    assert np.abs(angles).max() < np.radians(1)
    assert np.abs(np.diff(angles, axis=0)).max() < np.radians(0.05)
    assert np.abs(angles).max() > np.radians(0.2)


def test_lids_blink_once_an_interval_and_are_open_most_of_the_time() -> None:
    closed = np.array([lids_closed(t) for t in np.arange(0, 20 * BLINK_EVERY_SECS, 0.01)])
    assert closed.min() == 0
    assert closed.max() > 0.99
    starts = ((closed[1:] > 0) & (closed[:-1] == 0)).sum()
    assert starts == 20
    assert (closed > 0).mean() < 0.1


def test_idling_starts_with_open_lids() -> None:
    assert lids_closed(0.0) == 0


def test_blinks_do_not_tick_like_a_clock() -> None:
    times = np.arange(0, 10 * BLINK_EVERY_SECS, 0.01)
    closed = np.array([lids_closed(t) for t in times]) > 0
    starts = times[1:][closed[1:] & ~closed[:-1]]
    assert np.diff(starts).std() > 0.3
