"""Where the neutral is looked for, whoever came before."""

from fractions import Fraction
from pathlib import Path
from typing import cast

import cv2
import numpy as np
import pytest
from gemheads.app.errors import NoFaceError
from gemheads.app.files.sources import open_source
from gemheads.app.person.neutrals import find_neutral, read_rule
from gemheads.models.driver.face import FaceTracker


class Forgetful:
    """Notes what a tracker is told, and sees nobody."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def reset(self) -> None:
        self.told.append("reset")

    def track(self, rgb: np.ndarray, locked: object = None) -> None:
        self.told.append("track")


@pytest.mark.parametrize("rule", ["auto", "first", "frame=0", "time=0"])
def test_who_was_followed_in_another_clip_is_forgotten_first(tmp_path: Path, rule: str) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((32, 32, 3), np.uint8))
    tracker = Forgetful()
    with pytest.raises(NoFaceError):
        find_neutral(read_rule(rule), open_source(str(tmp_path), Fraction(30)), cast(FaceTracker, tracker))
    assert tracker.told[:2] == ["reset", "track"]
    assert tracker.told[-1] == "reset"
