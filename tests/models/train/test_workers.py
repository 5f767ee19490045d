"""Several processes that draw and learn: the same as one alone, and nothing of them is left when they are done."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import psutil
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

import labour  # noqa: E402
from gemheads.models.arkit import NAMES  # noqa: E402
from gemheads.models.driver.features import DIMENSION  # noqa: E402
from gemheads.models.gemfile import load_gem  # noqa: E402
from gemheads.models.train.regressors import closing, series, train_regressor  # noqa: E402
from gemheads.models.train.regressors.bystanders import leaks_of_bystanders  # noqa: E402
from gemheads.models.train.regressors.closing import ClosedLoop  # noqa: E402
from gemheads.models.train.regressors.controls import controls_of  # noqa: E402
from gemheads.models.train.regressors.leaks import Leaks, pose_leak  # noqa: E402
from gemheads.models.train.regressors.network import RegressorNetwork  # noqa: E402
from gemheads.models.train.regressors.reduction import compared_channels  # noqa: E402
from gemheads.models.train.regressors.strangers import Person, crowd  # noqa: E402
from gemheads.models.train.regressors.turns import learned_turns  # noqa: E402
from gemheads.models.train.workers import WorkerLost, Workers  # noqa: E402
from linearperson import linear_person  # noqa: E402
from toygem import toy_gem  # noqa: E402
from waiting import SOON, eventually  # noqa: E402

MARA = Path(__file__).parents[3] / "assets" / "avatars" / "mara.gem"
START = 60.0
"""Seconds that workers may need to start: they import torch, on cores that may be busy."""


def somebody(pictures: int) -> Person:
    rng = np.random.default_rng(0)
    shapes, leak = (rng.normal(0, 0.1, (rows, DIMENSION)).astype("f4") for rows in (len(NAMES), 3))
    return linear_person(shapes, leak, pictures, 1)


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    with Workers(2) as workers:
        yield workers


def test_answers_come_in_the_order_of_the_questions(workers: Workers) -> None:
    reached: list[int] = []
    answers = workers.each(labour.square, [(3, 0.8), (2, 0.1), (1, 0.1)], reached.append)
    assert [number for number, _ in answers] == [9, 4, 1]
    assert reached[-1] == 3
    assert reached == sorted(reached)
    again = workers.each(labour.square, [(5, 0.5), (6, 0.5)])
    assert [number for number, _ in again] == [25, 36]
    processes = {process for _, process in answers + again}
    assert len(processes) == 2
    assert os.getpid() not in processes


def test_each_computes_in_one_thread(workers: Workers) -> None:
    assert workers.each(labour.threads, [(1,), (2,)]) == [(1, 1, 1)] * 2


def test_one_job_is_done_here() -> None:
    reached: list[int] = []
    with Workers() as alone:
        answers = alone.each(labour.square, [(1,), (2,)], reached.append)
    assert answers == [(1, os.getpid()), (4, os.getpid())]
    assert reached == [1, 2]


@pytest.mark.parametrize(
    ("how", "error", "said"),
    [("fails", ValueError, "more than it can bear"), ("dies", WorkerLost, "fewer than --jobs 2")],
)
def test_what_goes_wrong_in_one_is_told_and_stops_the_others(how: str, error: type[Exception], said: str) -> None:
    began, before = time.monotonic(), helpers()
    with pytest.raises(error, match=said), Workers(2) as workers:
        workers.each(labour.troubled, [("goes on",), (how,), ("goes on",)])
    assert time.monotonic() - began < labour.LONG
    assert not helpers() - before


def helpers() -> set[psutil.Process]:
    """Processes that work for this one; what multiprocessing starts beside the first of them, and keeps, does not."""
    return {child for child in psutil.Process().children() if "spawn_main" in " ".join(child.cmdline())}


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_none_outlives_who_began_it(how: signal.Signals, tmp_path: Path) -> None:
    began = subprocess.Popen([sys.executable, labour.__file__, tmp_path / "note"], stderr=subprocess.PIPE)
    try:
        eventually(lambda: len(list(tmp_path.iterdir())) == 2, START)
        processes = [int(note.suffix[1:]) for note in tmp_path.iterdir()]
        assert all(map(psutil.pid_exists, processes))
        for process in [began.pid, *processes] if how == signal.SIGINT else [began.pid]:  # a terminal tells all
            os.kill(process, how)
        eventually(lambda: not any(map(psutil.pid_exists, processes)))
        _, said = began.communicate(timeout=SOON)
        assert said.count(b"Traceback") == (how == signal.SIGINT)
    finally:
        began.kill()
        began.wait()


def test_pictures_are_the_same_however_many_draw(workers: Workers, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(series, "LENGTH", 8)
    monkeypatch.setattr(train_regressor, "LENGTH", 8)
    gem = load_gem(MARA)
    reached: list[tuple[int, int]] = []
    alone, shared = (
        train_regressor.pictures_of(gem, 20, 3, lambda done, total: reached.append((done, total)), one)
        for one in (Workers(), workers)
    )
    for name in ("weights", "rotations", "features"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(shared, name))
    assert len(shared) >= 18
    assert reached[-1] == (20, 20)


def test_bystanders_are_the_same_however_many_look(workers: Workers) -> None:
    gems = [load_gem(MARA)]
    alone, shared = (leaks_of_bystanders(gems, 3, 2, workers=one) for one in (Workers(), workers))
    np.testing.assert_array_equal(alone.known, shared.known)


def test_networks_are_the_same_however_many_learn(workers: Workers, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(train_regressor, "CROWD", 400)
    controls, rng = controls_of(toy_gem()), np.random.default_rng(0)
    person = somebody(200)
    leaks = Leaks(pose_leak(person.seen)[None])
    school = train_regressor._School(controls, [person], leaks, np.empty((0, DIMENSION + 3), "f4"), rng)
    reached: list[tuple[int, int]] = []

    def networks(one: Workers) -> list[torch.nn.Module]:
        return school.networks(30, [4, 5], lambda _, done, total: reached.append((done, total)), one)

    alone, shared = networks(Workers()), networks(workers)
    assert reached[-1] == (60, 60)
    for one, other in zip(alone, shared, strict=True):
        for name, value in one.state_dict().items():
            assert torch.equal(value, other.state_dict()[name]), name
    assert not torch.equal(alone[0].layers[0].weight, alone[1].layers[0].weight)


def test_responses_are_the_same_however_many_learn(workers: Workers) -> None:
    seen = somebody(200).seen
    (alone, r2), (shared, r2_shared) = (
        train_regressor.person_of(seen, 20, 3, responses=2, workers=one) for one in (Workers(), workers)
    )
    assert r2 == r2_shared
    for one, other in zip((alone.response, *alone.doubters), (shared.response, *shared.doubters), strict=True):
        assert torch.equal(one.linear.weight, other.linear.weight)
    assert not torch.equal(alone.response.linear.weight, alone.doubters[0].linear.weight)


def test_what_follows_best_is_the_same_however_many_descend(workers: Workers, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closing, "AT_ONCE", 30)
    controls, rng = controls_of(toy_gem()), np.random.default_rng(0)
    person = somebody(200)
    people = crowd([person], Leaks(pose_leak(person.seen)[None]), np.empty((0, DIMENSION + 3), "f4"), 100, rng)
    loop = ClosedLoop(RegressorNetwork(compared_channels(people.features), controls), person, people)
    alone, shared = loop.best(), loop.best(workers)
    np.testing.assert_array_equal(alone, shared)
    assert len(shared) == 100


def test_turns_are_the_same_however_many_learn(workers: Workers) -> None:
    seen = somebody(100).seen
    alone, shared = (learned_turns(seen, 10, 2, one) for one in (Workers(), workers))
    np.testing.assert_array_equal(alone.left_deg, shared.left_deg)
    for one, other in zip(alone.poses, shared.poses, strict=True):
        assert torch.equal(one.linear.weight, other.linear.weight)
