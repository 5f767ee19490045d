from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from faces import face
from gemheads.app.errors import NoFaceError
from gemheads.app.files.frames import Frame
from gemheads.app.inputs.demotrack import weights_of
from gemheads.models.arkit import NAMES
from gemheads.models.driver.face import FaceObservation


class Clip:
    """Thirty pictures a second of nothing; the tracker knows better."""

    path, rate, time_base = "clip.mp4", Fraction(30), Fraction(1, 30)

    def frames(self) -> list[Frame]:
        return [Frame(np.full((32, 32, 3), index, np.uint8), index, self.time_base) for index in range(90)]

    def samples(self, count: int) -> list[Frame]:
        return self.frames()[::10]


class Watcher:
    """Sees a mouth that opens in the middle."""

    def __init__(self, blind_at: int = -1) -> None:
        self.blind_at = blind_at

    def track(self, rgb: np.ndarray) -> FaceObservation | None:
        index = int(rgb[0, 0, 0])
        return None if index == self.blind_at else face(jaw=0.8 if 30 <= index < 50 else 0.0)

    def reset(self) -> None:
        pass


def test_a_clip_becomes_a_performance_that_plays_in_a_circle() -> None:
    clip: Any = Clip()
    watcher: Any = Watcher()
    track = weights_of(clip, watcher)
    jaw = track.weights[:, NAMES.index("jawOpen")]
    assert len(jaw) == 90 - 18
    assert jaw[40] == pytest.approx(0.92, abs=0.01)
    assert jaw[0] == pytest.approx(jaw[-1], abs=0.01)
    assert 0.1 < np.abs(np.diff(jaw)).max() < 0.5  # smoothed, but not asleep
    assert track.pts.tolist() == list(range(72))


def test_a_clip_that_loses_its_face_is_no_performance() -> None:
    clip: Any = Clip()
    watcher: Any = Watcher(blind_at=77)
    with pytest.raises(NoFaceError, match=r"2\.57 s"):
        weights_of(clip, watcher)
