from collections.abc import Callable
from itertools import pairwise

import pytest
from gemheads.app.performing.ladder import (
    BUDGET_MS,
    MOST_SPARE_SECS,
    RUNGS,
    SLOW_SECS,
    SPARE_SECS,
    Ladder,
    Quality,
    quality,
    said,
    update,
)

ALL = Quality(50)
DT = 1 / 30


def run(ladder: Ladder, frame_ms: float, secs: float, wanted: Quality = ALL) -> Ladder:
    for _ in range(round(secs / DT)):
        ladder = update(ladder, frame_ms, DT, wanted)
    return ladder


def machine(ladder: Ladder, cost: Callable[[Quality], float], secs: float, wanted: Quality = ALL) -> list[Ladder]:
    """The ladder over time on a machine for which a frame costs this."""
    history = []
    for _ in range(round(secs / DT)):
        ladder = update(ladder, cost(quality(ladder, wanted)), DT, wanted)
        history.append(ladder)
    return history


def test_a_fast_machine_stays_at_the_top_and_nothing_is_said() -> None:
    ladder = run(Ladder(), 20.0, 60.0)
    assert (ladder.rung, quality(ladder, ALL), said(ALL, ALL)) == (0, ALL, "")


def test_one_slow_frame_is_no_slow_machine() -> None:
    ladder = run(Ladder(), 20.0, 5.0)
    for _ in range(10):
        ladder = run(update(ladder, 400.0, DT, ALL), 20.0, 2.0)
    assert ladder.rung == 0


def test_it_steps_down_in_the_order_of_the_ladder_and_says_so() -> None:
    history = machine(Ladder(), lambda _: 100.0, 20.0)
    seen = list(dict.fromkeys((entry.rung, said(quality(entry, ALL), ALL)) for entry in history))
    assert [rung for rung, _ in seen] == [0, 1, 2, 3, 4, 5]
    assert seen[1][1] == "This machine is slow: 30 components."
    assert seen[3][1] == "This machine is slow: 10 components, drawn at 75% of its size."
    assert "one picture of the camera in 2" in seen[-1][1]
    assert said(quality(Ladder(rung=3), Quality(5)), Quality(5)) == "This machine is slow: drawn at 75% of its size."
    assert run(Ladder(), 100.0, SLOW_SECS - 0.2).rung == 0
    assert run(Ladder(), 100.0, SLOW_SECS + 0.2).rung == 1


def test_it_settles_where_the_budget_is_met() -> None:
    history = machine(Ladder(), lambda q: 15 + 0.6 * q.components * q.scale, 30.0)
    assert {entry.rung for entry in history[150:]} == {1}
    assert quality(history[-1], ALL).components == 30


def test_it_climbs_when_the_machine_has_room_again() -> None:
    ladder = machine(Ladder(), lambda _: 100.0, 20.0)[-1]
    assert run(ladder, 10.0, SPARE_SECS - 0.5).rung == 5
    assert run(ladder, 10.0, SPARE_SECS + 1.5).rung == 4
    assert run(ladder, 10.0, 40.0).rung == 0


def test_a_machine_between_two_rungs_does_not_swing() -> None:
    """The upper rung is too slow, the lower leaves room: tried again ever more rarely."""
    history = machine(Ladder(), lambda q: 40.0 if q.components > 30 else 15.0, 600.0)
    changes = [now.rung for before, now in pairwise(history) if before.rung != now.rung]
    assert 4 <= len(changes) <= 26
    last = [entry.rung for entry in history[-round(2 * MOST_SPARE_SECS / DT) :]]
    assert last.count(0) < 0.05 * len(last)


def test_a_time_between_spare_and_budget_changes_nothing() -> None:
    assert run(Ladder(rung=2), 0.85 * BUDGET_MS, 120.0).rung == 2


def test_rungs_that_take_nothing_from_what_is_wanted_are_passed_over() -> None:
    few = Quality(12)
    history = machine(Ladder(), lambda _: 100.0, 20.0, few)
    assert list(dict.fromkeys(entry.rung for entry in history)) == [0, 2, 3, 4, 5]
    back = machine(history[-1], lambda _: 5.0, 60.0, few)
    assert list(dict.fromkeys(entry.rung for entry in back)) == [5, 4, 3, 2, 0]


@pytest.mark.parametrize("wanted", [Quality(50), Quality(5), Quality(20, 0.6, 3)])
def test_no_rung_gives_more_than_is_wanted(wanted: Quality) -> None:
    for rung in range(len(RUNGS)):
        given = quality(Ladder(rung=rung), wanted)
        assert given.components <= wanted.components
        assert given.scale <= wanted.scale
        assert given.detector_every >= wanted.detector_every
