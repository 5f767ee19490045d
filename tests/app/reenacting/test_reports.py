"""What a report says of a run."""

import numpy as np
import pytest
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.presence import Phase
from gemheads.app.reenacting.reports import Outcome, Tally


def test_frames_a_second_are_counted_from_the_first() -> None:
    outcome = Outcome("a.mp4", "b.mp4", "done", Tally(frames=40), seconds=3.0, first_frame_seconds=1.0)
    assert outcome.rate == 20.0
    assert Outcome("a.mp4", "b.mp4", "failed", seconds=1.0).rate == 0.0


def tallied(*frames: tuple[Phase, int, float]) -> Tally:
    """Of frames with a phase, so many faces, and so much light."""
    tally = Tally()
    for phase, faces, luma in frames:
        tally.add(Pose(np.zeros(3, np.float32), np.zeros(3, np.float32), phase, faces, 0.0, cut=False), luma)
    return tally


SEEN, LOST = (Phase.TRACKING, 1, 0.5), (Phase.IDLE, 0, 0.5)


def test_a_clip_in_which_a_face_is_seen_needs_no_remark() -> None:
    assert Tally().remark == ""
    assert tallied(*[SEEN] * 19, LOST).remark == ""


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        (LOST, "no face in 75% of the frames, where the avatar rests: show the face"),
        ((Phase.IDLE, 0, 0.05), "no face in 75% of the frames (75% are dark), where the avatar rests: put a lamp"),
        ((Phase.TRACKING, 2, 0.5), "several faces in 75% of the frames, of which one is followed: if it is the wrong"),
    ],
)
def test_what_made_a_face_hard_to_follow_is_told_with_its_cure(frame: tuple[Phase, int, float], said: str) -> None:
    tally = tallied(SEEN, *[frame] * 3)
    assert tally.remark.startswith(said)
    assert "\n" not in tally.remark
    assert tally.as_json()["dark_frames_without_face"] == 3 * (frame[2] < 0.1)
