import numpy as np
import pytest
from faces import face
from gemheads.app.person.settling import (
    COLLECT_SECS,
    PATIENCE_SECS,
    RECHOOSE_SHARE,
    SPACING_SECS,
    Settling,
    settle,
)
from gemheads.models.driver.face import FaceObservation
from gemheads.models.driver.features import score
from gemheads.models.driver.neutral import neutral_of

DT = 1 / 30


def run(faces: list[FaceObservation], start: Settling | None = None, strength: float = 1.0) -> list[Settling]:
    states = [start or Settling()]
    for index, seen in enumerate(faces):
        states.append(settle(states[-1], seen, index * DT, DT, strength))
    return states[1:]


def jaws(states: list[Settling]) -> np.ndarray:
    return np.array([float(score(state.now.features, "jawOpen")) for state in states if state.now])


def test_there_is_a_provisional_neutral_from_the_first_face_on() -> None:
    first = run([face(jaw=0.4)])[0]
    assert first.now is not None
    assert not first.settled


def test_an_open_mouth_at_first_gives_way_to_the_closed_one_without_a_jerk() -> None:
    states = run([face(jaw=0.6)] * 10 + [face()] * 190)
    assert jaws(states)[0] == pytest.approx(0.6)
    assert jaws(states)[-1] == pytest.approx(0, abs=0.02)
    assert np.abs(np.diff(jaws(states))).max() < 0.12
    assert states[-1].final
    assert states[-1].faces == ()  # nothing of the person is kept but the neutral


def test_it_takes_its_time_and_no_more() -> None:
    states = run([face()] * 200)
    settled = next(index for index, state in enumerate(states) if state.settled)
    assert settled * DT == pytest.approx(COLLECT_SECS, rel=RECHOOSE_SHARE)


def test_somebody_who_never_looks_at_the_camera_settles_too() -> None:
    states = run([face(turn=(0, 0.7, 0))] * 610)
    settled = next(index for index, state in enumerate(states) if state.settled)
    assert settled * DT == pytest.approx(PATIENCE_SECS, abs=2 * DT)
    assert not states[-1].at_rest


def test_who_talks_for_long_at_first_is_waited_for() -> None:
    """What the first seconds show would be counted as rest for as long as the window is open."""
    states = run([face(jaw=0.5, lips_cm=1.0)] * 300 + [face()] * 150)
    assert not any(state.at_rest for state in states[:300])
    assert states[-1].at_rest
    assert jaws(states)[-1] == pytest.approx(0, abs=0.02)


def test_of_a_long_time_few_faces_are_kept() -> None:
    states = run([face(jaw=0.5, lips_cm=1.0)] * 500)
    assert max(len(state.faces) for state in states) <= PATIENCE_SECS / SPACING_SECS + 1


def test_a_given_neutral_counts_as_much_as_the_slider_says() -> None:
    automatic = run([face()] * 60)[-1]
    given = Settling(automatic.automatic, True, neutral_of(face(jaw=0.8), 0, 0.0, "taken"), automatic.now)
    assert jaws(run([face()] * 60, given))[-1] == pytest.approx(0.8, abs=0.01)
    assert jaws(run([face()] * 60, given, strength=0.25))[-1] == pytest.approx(0.2, abs=0.01)
    assert given.settled
    assert given.reason == "taken"
