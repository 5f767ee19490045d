"""Several processes that judge: the same figures as one alone, and nothing of them is left when they are done."""

import time
from pathlib import Path

import cv2
import numba
import numpy as np
import psutil
import pytest

pytest.importorskip("torch", reason="judging needs the extra gemheads[train]")

import torch
from gemheads.models.captures.layout import CaptureError, Shot
from gemheads.models.captures.reader import Capture, open_capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.gemfile import save_gem
from gemheads.models.importers.adopt import adopt
from gemheads.models.importers.baremesh import capture_source
from gemheads.models.metrics.pixels import BEST_DB
from gemheads.models.train.judging.contestants import Act
from gemheads.models.train.judging.crew import Crew
from gemheads.models.train.judging.evaluate import Alone, Moment, fill
from gemheads.models.train.judging.judge import Judge
from gemheads.models.train.judging.ledger import Ledger, Record, ShotKeys
from gemheads.models.train.workers import WorkerLost
from gemheads.render.arrays import Floats32
from judges import Opens, Trouble, without_lpips


@pytest.fixture(scope="module")
def footage(toy_capture: Path) -> Capture:
    return open_capture(toy_capture)


@pytest.fixture(scope="module")
def avatar(footage: Capture, tmp_path_factory: pytest.TempPathFactory) -> Path:
    gem, _ = adopt(capture_source(footage, 24, lambda *_: None), "toy", 4, {}, lambda *_: None)
    path = tmp_path_factory.mktemp("avatars") / "toy.gem"
    save_gem(gem, path)
    return path


def moments(footage: Capture) -> list[Moment]:
    return [
        Moment(split, (shot,), (f"{split} {shot.timestep} {shot.camera_index}",))
        for split in ("val", "test")
        for shot in footage.shots(split)[:3]
    ]


def same(one: Record, other: Record) -> bool:
    arrays = ("coefficients", "turn", "move")
    return one.values == other.values and all(
        np.array_equal(getattr(one.act, name), getattr(other.act, name)) for name in arrays
    )


def test_figures_do_not_depend_on_how_many_judge(footage: Capture, avatar: Path, tmp_path: Path) -> None:
    shots = {split: footage.shots(split)[:count] for split, count in (("val", 1), ("test", 2))}
    keys = ShotKeys(footage, ())
    found = []
    alone = Alone(Opens(avatar)(footage), footage, Judge(None))
    found.append(fill(alone, shots, Ledger(tmp_path / "1.json", "a"), keys))
    with Crew(2, footage, without_lpips) as crew:
        told: list[int] = []
        ledger = Ledger(tmp_path / "2.json", "a")
        found.append(fill(crew.judging("a", Opens(avatar)), shots, ledger, keys, lambda: told.append(1)))
        children = psutil.Process().children(recursive=True)
        assert len([child for child in children if child.is_running()]) >= 2
    assert len(told) == 3
    assert len(Ledger(tmp_path / "2.json", "a")) == 3  # it is on the disk
    assert not [child for child in children if "spawn_main" in " ".join(_words(child))]
    for split in shots:
        assert all(same(one, other) for one, other in zip(found[0][split], found[1][split], strict=True))


def _words(process: psutil.Process) -> list[str]:
    try:
        return process.cmdline()
    except psutil.NoSuchProcess:
        return []


@pytest.mark.parametrize(
    ("how", "error", "said"),
    [
        ("is changed", CaptureError, "is gone; copy it there"),
        ("cannot", ValueError, "more than it can bear"),
        ("dies", WorkerLost, "fewer than --jobs 1"),
    ],
)
def test_what_goes_wrong_in_a_worker_is_told_by_its_parent(
    footage: Capture, how: str, error: type[Exception], said: str
) -> None:
    began = time.monotonic()
    with pytest.raises(error, match=said), Crew(1, footage, without_lpips) as crew:
        list(crew.records("a", Trouble(how), moments(footage)))
    assert time.monotonic() - began < 60


def test_nothing_starts_where_nothing_is_left_to_judge(
    footage: Capture, avatar: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shots = {"val": footage.val[:1]}
    keys, ledger = ShotKeys(footage, ()), Ledger(tmp_path / "a.json", "a")
    first = fill(Alone(Opens(avatar)(footage), footage, Judge(None)), shots, ledger, keys)
    monkeypatch.setattr(Crew, "_start", lambda *_: pytest.fail("a process was started"))
    with Crew(2, footage, without_lpips) as crew:
        again = fill(crew.judging("a", Opens(avatar)), shots, ledger, keys)
    assert first == again


class Counting:
    """Notes how many threads compute while it acts."""

    driven_by = "nothing"

    def __init__(self) -> None:
        self.threads: list[tuple[int, int, int]] = []

    def act(self, shot: Shot, split: str) -> Act:
        self.threads.append((torch.get_num_threads(), numba.get_num_threads(), cv2.getNumThreads()))
        return Act(None, None, None, (), 0.0)

    def draw(self, standin: StandIn, shot: Shot, act: Act) -> Floats32:
        return standin.truth(shot)


def test_one_thread_computes_however_many_there_are(footage: Capture) -> None:
    """Else sums come in another order on another machine, and fits elsewhere."""
    before = torch.get_num_threads(), numba.get_num_threads(), cv2.getNumThreads()
    torch.set_num_threads(2)
    try:
        counting = Counting()
        ((_, record),) = Alone(counting, footage, Judge(None)).records(moments(footage)[:1])
        assert counting.threads == [(1, 1, 1)]
        assert record.values["PSNR"] == BEST_DB
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before[0])
    assert (torch.get_num_threads(), numba.get_num_threads(), cv2.getNumThreads()) == before
