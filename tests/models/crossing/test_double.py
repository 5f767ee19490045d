"""The double does what the driver does; what the tracker reads of it is put back from the mirror."""

import numpy as np
import pytest
from gemheads.models.crossing.channels import CHANNELS
from gemheads.models.crossing.clip import Clip, track_clip
from gemheads.models.crossing.double import double_correlations, mirrored
from gemheads.models.driver.face import FaceObservation
from numpy.typing import NDArray
from pixelface import PixelTracker, painted

from .conftest import RATE, performed

NAMES = [channel.name for channel in CHANNELS]


def test_a_double_moves_as_the_driver_does(clip: Clip) -> None:
    double = mirrored(clip, performed())
    assert double.seen.all()
    found = dict(zip(NAMES, double_correlations(clip, double), strict=True))
    assert found["jawOpen"] == pytest.approx(1)
    assert found["mouthSmile"] == pytest.approx(1)
    assert np.isnan(found["browDown"])  # nobody moved them
    # paint has no left and right: what is read of it turns as the driver does, and a mirror image would not
    assert found["yaw"] == pytest.approx(-1)


def test_the_same_frames_are_looked_at_and_none_behind_them(clip: Clip) -> None:
    some = track_clip(performed(), 3, 1.0)
    given = 0

    def counted():
        nonlocal given
        for frame in performed():
            given += 1
            yield frame

    double = mirrored(some, counted())
    assert len(double.readings) == len(some.readings)
    np.testing.assert_allclose(double.readings.features, some.readings.features)
    assert given <= RATE + 2


def test_mirror_images_without_a_face_do_not_count(clip: Clip, monkeypatch: pytest.MonkeyPatch) -> None:
    class Blind(PixelTracker):
        def track(self, rgb: NDArray[np.uint8], locked: object = None) -> FaceObservation | None:
            found = super().track(rgb)
            return found if self.looks % 2 else None

    monkeypatch.setattr("gemheads.models.crossing.double.FaceTracker", Blind)
    double = mirrored(clip, performed())
    assert double.seen.tolist() == [i % 2 == 0 for i in range(len(clip.times))]
    assert double_correlations(clip, double)[NAMES.index("jawOpen")] == pytest.approx(1)


def test_a_double_who_is_not_seen_says_nothing(clip: Clip) -> None:
    black = ((np.zeros_like(painted()), now) for _, now in performed())
    double = mirrored(clip, black)
    assert not double.seen.any()
    assert np.isnan(double_correlations(clip, double)).all()
