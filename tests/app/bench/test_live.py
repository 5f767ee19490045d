import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from gemheads.app.bench.live import GOALS, LiveReport, run_live_bench
from gemheads.app.bench.screen import FramebufferReader
from gemheads.app.bench.source import RATE, StampedCamera
from gemheads.app.bench.stamp import ACROSS, CELLS, NUMBERS, cell_centres, read, stamp
from gemheads.app.bench.witness import Witness
from gemheads.app.desk.layout import laid_out
from gemheads.app.desk.state import DeskState
from gemheads.app.desk.view import DeskView
from gemheads.app.errors import InputError, UsageError
from gemheads.app.performing.figures import Spread
from gemheads.models.gemfile import save_gem
from gemheads.render.contexts import NoOpenGLError, offscreen_context
from gems import ball
from hypothesis import given
from hypothesis import strategies as st

NUMBER = st.integers(0, NUMBERS - 1)


def stamped(number: int, size: tuple[int, int] = (64, 48), kind: Any = np.uint8, channels: int = 3) -> np.ndarray:
    picture = (
        np.random.default_rng(number).random((size[1], size[0], channels)) * (255 if kind is np.uint8 else 1)
    ).astype(kind)
    stamp(picture, number)
    return picture


@given(NUMBER, st.sampled_from([(64, 48), (512, 512), (333, 200)]), st.booleans())
def test_a_number_is_read_where_it_was_drawn(number: int, size: tuple[int, int], floats: bool) -> None:
    picture = stamped(number, size, np.float32, 4) * 255 if floats else stamped(number, size)
    columns, row = cell_centres(0, 0, size[0] // ACROSS * ACROSS)
    assert read(picture[row, columns, 1]) == number


@given(NUMBER, st.sampled_from([384, 512, 740, 1000]), st.booleans())
def test_it_survives_scaling_and_mirrors(number: int, width: int, mirrored: bool) -> None:
    picture = cv2.resize(stamped(number, (512, 512)), (width, width), interpolation=cv2.INTER_LINEAR)
    picture = picture[:, ::-1] if mirrored else picture
    screen = np.zeros((width + 30, width + 300, 3), np.uint8)
    screen[20 : 20 + width, 120 : 120 + width] = picture
    columns, row = cell_centres(120, 20, width, mirrored)
    assert read(screen[row, columns, 1]) == number


@given(NUMBER, st.integers(0, CELLS - 1))
def test_a_cell_that_is_wrong_is_noticed(number: int, cell: int) -> None:
    picture = stamped(number)
    columns, row = cell_centres(0, 0, 64)
    lumas = picture[row, columns, 1].copy()
    lumas[cell] = 255 - lumas[cell]
    assert read(lumas) is None


def test_the_camera_delivers_in_time_whoever_looks() -> None:
    now = [10.0]
    camera = StampedCamera([np.full((48, 64, 3), value, np.uint8) for value in (10, 20, 30)], lambda: now[0])
    first = camera.read(0.0)
    assert first is not None
    assert (first.pts, first.seconds, first.delivered) == (0, 0.0, 10.0)
    assert camera.read(0.0) is None
    now[0] += 5 / RATE + 0.001
    late = camera.read(0.0)
    assert late is not None
    assert late.pts == 5
    assert late.delivered == pytest.approx(10.0 + 5 / RATE)  # when it was due, not when it was read
    assert camera.drops == 4
    columns, row = cell_centres(0, 0, 64)
    assert read(late.rgb[row, columns, 1]) == 5
    assert late.rgb[40, 60, 0] == 20  # 0 1 2 1 0 1: forwards and backwards


class Screen:
    """Stands for a window and its pixels: a picture appears on it ``lag`` seconds after it was shown."""

    def __init__(self, lag: float) -> None:
        self.size, self.lag, self.shown, self.context = (1280, 800), lag, [], None
        self.pixels = np.zeros((800, 1280), np.uint8)

    def poll(self, wait: float = 0.0) -> list:
        return []

    def show(self, picture: np.ndarray, view: DeskView) -> None:
        time.sleep(self.lag)
        area = laid_out(view, *self.size).picture.fitted(*picture.shape[1::-1])
        scaled = cv2.resize(picture[..., 1], (round(area.width), round(area.height)))
        scaled = scaled[:, ::-1] if view.state.mirror else scaled
        self.pixels[round(area.top) :, round(area.left) :][: scaled.shape[0], : scaled.shape[1]] = scaled

    def row(self, columns: np.ndarray, row: int) -> np.ndarray:
        return self.pixels[row, columns]


@pytest.mark.parametrize("mirror", [True, False])
def test_the_witness_counts_what_is_to_be_seen(mirror: bool) -> None:
    screen = Screen(lag=0.01)
    camera: Any = SimpleNamespace(delivered=lambda number: start + number * 0.05)
    view = DeskView(state=DeskState(mirror=mirror))
    start = time.perf_counter()
    witness = Witness(screen, screen, camera, warm_up=0.0, seconds=60.0)  # pyright: ignore[reportArgumentType]
    witness.show(stamped(0, (512, 512)), view)
    witness.poll()
    for number in (1, 2, 2, 5):
        time.sleep(max(0.0, camera.delivered(number) - time.perf_counter()))
        witness.show(stamped(number, (512, 512)), view)
    witness.show(np.zeros((512, 512, 3), np.uint8), view)
    assert witness.latencies.count == witness.frames.count == 3
    assert witness.skipped == 2  # 3 and 4 were never shown
    assert witness.unread == 1
    assert witness.latencies.values[: witness.latencies.count].min() >= 0.01


def test_the_witness_ends_the_run() -> None:
    screen = Screen(lag=0.0)
    camera: Any = SimpleNamespace(delivered=lambda number: 0.0)
    witness = Witness(screen, screen, camera, warm_up=0.0, seconds=0.05)  # pyright: ignore[reportArgumentType]
    assert witness.poll() == []
    witness.show(stamped(1, (512, 512)), DeskView())
    assert witness.poll() == []
    time.sleep(0.06)
    assert witness.poll() == []  # nothing new was to be seen yet
    witness.show(stamped(2, (512, 512)), DeskView())
    assert [order.name for order in witness.poll()] == ["quit"]


def test_goals_are_met_or_missed_by_the_figures() -> None:
    spread = Spread(50.0, 90.0)
    good = LiveReport(
        *("a processor", 2, 0.5, "window", "software", "a camera", "mara", 20000, 30, (512, 512), 10.0),
        *(29.9, spread, 300, 1, 0, {}, spread, 1.5, 40.0, 0.0, 500.0, 0.1),
    )
    assert set(good.goals()) == set(GOALS)
    assert all(met for _, met in good.goals().values())
    slow = LiveReport(**{**good.__dict__, "latency": Spread(50.0, 101.0), "pictures_per_second": 20.0})
    missed = [name for name, (_, met) in slow.goals().items() if not met]
    assert missed == ["pictures a second", "latency p95"]


def test_the_whole_live_loop_is_measured_without_a_display(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        offscreen_context().release()
    except NoOpenGLError as error:
        pytest.skip(str(error))
    monkeypatch.setattr("gemheads.app.bench.live.has_display", lambda: False)
    report = run_live_bench(1.5, avatar="mara", engine="software", components=7, size=(192, 192), warm_up=1.0)
    assert (report.unread, report.components) == (0, 7)
    assert report.pictures_per_second > 0
    assert report.latency.median > 0
    assert {"track", "express", "compose", "draw"} <= set(report.stages)
    assert report.window == "no display: offscreen"
    assert "latency, delivered to seen" in capsys.readouterr().out


def test_a_framebuffer_is_read_from_the_top_left() -> None:
    try:
        context = offscreen_context()
    except NoOpenGLError as error:
        pytest.skip(str(error))
    target = context.simple_framebuffer((64, 32), 4)
    target.use()
    target.clear(0, 0, 0, 1)
    target.clear(1, 1, 1, 1, viewport=(10, 32 - 4 - 1, 1, 1))  # the fifth row from the top
    lumas = FramebufferReader(context).row(np.array([12, 10, 8]), 4)
    assert lumas is not None
    assert lumas.tolist() == [0, 255, 0]
    context.release()


@pytest.mark.parametrize("kind", ["broken", "undriven"])
def test_an_avatar_that_cannot_be_measured_is_refused_at_once(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "a.gem"
    if kind == "broken":
        path.write_bytes(b"no avatar")
    else:
        save_gem(replace(ball(), arkit_weights=None), path)
    with pytest.raises(InputError, match=r"a\.gem"):
        run_live_bench(avatar=str(path))


def test_figures_are_not_written_over_the_avatar(tmp_path: Path) -> None:
    avatar = tmp_path / "a.gem"
    avatar.write_bytes(b"an avatar")
    with pytest.raises(UsageError, match=r"a\.gem: would be written over"):
        run_live_bench(json=avatar, avatar=str(avatar))
    assert avatar.read_bytes() == b"an avatar"
