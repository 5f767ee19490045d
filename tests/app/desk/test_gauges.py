"""What the window's gauges tell the quality ladder."""

from gemheads.app.desk.gauges import Gauges
from gemheads.app.performing.ladder import Quality


def after(frame_secs: float, worked_secs: float, frames: int) -> Quality:
    """The quality after so many frames, each so long after the one before."""
    gauges = Gauges()
    for number in range(frames):
        gauges.shown(None, worked_secs, 50, True, number * frame_secs)
    return gauges.quality(50)


def test_a_machine_that_takes_longer_than_any_gap_is_helped_too() -> None:
    for secs in (0.1, 0.4, 0.6, 3.0):
        assert after(secs, secs, 60) == Quality(10, 0.5, 2), secs


def test_gaps_that_were_no_work_and_a_single_long_frame_take_nothing() -> None:
    assert after(2.0, 0.01, 60) == Quality(50)
    gauges = Gauges()
    now = 0.0
    for number in range(60):
        secs = 0.9 if number == 30 else 0.02
        now += secs
        gauges.shown(None, secs, 50, True, now)
    assert gauges.quality(50) == Quality(50)
