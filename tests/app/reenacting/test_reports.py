"""What a report says of a run."""

from gemheads.app.reenacting.reports import Outcome, Tally


def test_frames_a_second_are_counted_from_the_first() -> None:
    outcome = Outcome("a.mp4", "b.mp4", "done", Tally(frames=40), seconds=3.0, first_frame_seconds=1.0)
    assert outcome.rate == 20.0
    assert Outcome("a.mp4", "b.mp4", "failed", seconds=1.0).rate == 0.0
