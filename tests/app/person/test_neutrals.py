"""Where the neutral is looked for, whoever came before."""

from fractions import Fraction
from pathlib import Path
from typing import cast

import cv2
import numpy as np
import pytest
from faces import face
from gemheads.app.errors import NoFaceError
from gemheads.app.files.sources import open_source
from gemheads.app.person.neutrals import find_neutral, read_rule
from gemheads.models.driver.face import FaceObservation, FaceTracker


class Forgetful:
    """Notes what a tracker is told, and sees nobody."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def reset(self) -> None:
        self.told.append("reset")

    def track(self, rgb: np.ndarray, locked: object = None) -> FaceObservation | None:
        self.told.append("track")


class Between(Forgetful):
    """Sees a face in some pictures, which are told apart by how bright they are: with an open mouth in the first."""

    def __init__(self, seen: range) -> None:
        super().__init__()
        self.seen = seen

    def track(self, rgb: np.ndarray, locked: object = None) -> FaceObservation | None:
        number = int(rgb[0, 0, 0])
        return face(jaw=0.6 if number == self.seen[0] else 0.0) if number in self.seen else None


@pytest.mark.parametrize("seen", [range(33, 63), range(34, 35)], ids=["late", "between"])
def test_who_comes_late_or_between_what_is_looked_at_is_judged_all_the_same(tmp_path: Path, seen: range) -> None:
    for number in range(63):
        cv2.imwrite(str(tmp_path / f"{number:02}.png"), np.full((32, 32, 3), number, np.uint8))
    source, tracker = open_source(str(tmp_path), Fraction(30)), Between(seen)
    choice = find_neutral(read_rule("auto"), source, cast(FaceTracker, tracker))
    assert round(choice.time * 30) in (seen[1:] or seen)


@pytest.mark.parametrize(("luma", "said"), [(8, "which is dark"), (120, "or show less of the picture")])
def test_a_clip_that_shows_nobody_because_it_is_dark_is_told_so(tmp_path: Path, luma: int, said: str) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.full((32, 32, 3), luma, np.uint8))
    with pytest.raises(NoFaceError, match=said):
        find_neutral(read_rule("auto"), open_source(str(tmp_path), Fraction(30)), cast(FaceTracker, Forgetful()))


@pytest.mark.parametrize("rule", ["auto", "first", "frame=0", "time=0"])
def test_who_was_followed_in_another_clip_is_forgotten_first(tmp_path: Path, rule: str) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((32, 32, 3), np.uint8))
    tracker = Forgetful()
    with pytest.raises(NoFaceError):
        find_neutral(read_rule(rule), open_source(str(tmp_path), Fraction(30)), cast(FaceTracker, tracker))
    assert tracker.told[:2] == ["reset", "track"]
    assert tracker.told[-1] == "reset"
