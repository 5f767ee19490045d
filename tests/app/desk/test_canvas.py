from collections.abc import Iterator

import numpy as np
import pytest
from gemheads.app.desk.canvas import Box, boxes_around
from gemheads.app.desk.offscreen import DeskOffscreen
from gemheads.app.desk.picture import Area
from gemheads.app.desk.state import DeskState
from gemheads.app.desk.view import DeskView
from gemheads.render.contexts import NoOpenGLError
from hypothesis import given
from hypothesis import strategies as st

LENGTH = st.floats(-20, 120)


@given(LENGTH, LENGTH, st.floats(1, 90), st.floats(1, 90))
def test_each_pixel_is_in_the_area_or_in_one_box(left: float, top: float, width: float, height: float) -> None:
    area, counts = Area(left, top, width, height), np.zeros((60, 100), int)
    for box_left, bottom, box_width, box_height in boxes_around(area, 100, 60):
        assert box_left >= 0
        assert bottom >= 0
        counts[60 - bottom - box_height : 60 - bottom, box_left : box_left + box_width] += 1
    columns, rows = np.arange(100) + 0.5, np.arange(60) + 0.5
    across = (columns >= left) & (columns < left + width)
    down = (rows >= top) & (rows < top + height)
    inside = across[None, :] & down[:, None]
    assert (counts == ~inside).all()


@pytest.fixture
def desk() -> Iterator[DeskOffscreen]:
    try:
        opened = DeskOffscreen((900, 600))
    except NoOpenGLError as error:
        pytest.skip(str(error))
    yield opened
    opened.close()


@pytest.mark.parametrize("mirror", [True, False])
@pytest.mark.parametrize("shape", [(64, 64, 3), (50, 70, 4)])
def test_a_quick_frame_is_the_same_as_a_whole_one(
    desk: DeskOffscreen, monkeypatch: pytest.MonkeyPatch, mirror: bool, shape: tuple[int, int, int]
) -> None:
    """Panels are kept, the picture is drawn anew: nothing of it may be seen."""
    view = DeskView(state=DeskState(welcome=False, mirror=mirror))
    first, second = np.random.default_rng(0).integers(0, 255, (2, *shape), np.uint8)
    draws: list[bool] = []
    draw_panels = desk.screen._draw_panels
    monkeypatch.setattr(desk.screen, "_draw_panels", lambda *given: (draws.append(True), draw_panels(*given)))

    def show(picture: np.ndarray, touched: bool) -> np.ndarray:
        with desk.context:
            desk.screen.put(picture)
            desk.screen.draw(view, desk._target, touched=touched)
        return desk.pixels()

    desk.show(first, view)  # imgui settles its windows in the first frames
    desk.show(first, view)
    monkeypatch.setattr("gemheads.app.desk.screen.PANELS_EVERY", 1e9)
    before = len(draws)
    quick = show(second, touched=False)
    assert len(draws) == before
    around = show(second, touched=True)
    monkeypatch.setattr("gemheads.app.desk.screen.covers", lambda view, layout: True)
    whole = show(second, touched=False)
    assert len(draws) == before + 2
    assert (quick == whole).all()
    assert (around == whole).all()


@pytest.mark.parametrize("mirror", [True, False])
def test_where_the_screen_keeps_what_was_drawn_only_the_picture_is_drawn_and_named(
    desk: DeskOffscreen, monkeypatch: pytest.MonkeyPatch, mirror: bool
) -> None:
    view = DeskView(state=DeskState(welcome=False, mirror=mirror))
    first, second = np.random.default_rng(0).integers(0, 255, (2, 64, 64, 3), np.uint8)

    def show(picture: np.ndarray, kept: bool, touched: bool) -> tuple[np.ndarray, Box | None]:
        desk.screen.kept = kept
        with desk.context:
            desk.screen.put(picture)
            changed = desk.screen.draw(view, desk._target, touched=touched)
        return desk.pixels(), changed

    desk.show(first, view)  # imgui settles its windows in the first frames
    desk.show(first, view)
    monkeypatch.setattr("gemheads.app.desk.screen.PANELS_EVERY", 1e9)
    wanted, everything = show(second, kept=False, touched=True)
    assert everything is None
    before, everything = show(first, kept=True, touched=True)
    assert everything is None
    drawn, changed = show(second, kept=True, touched=False)
    assert (drawn == wanted).all()
    assert changed is not None
    left, bottom, width, height = changed
    outside = np.ones(drawn.shape[:2], bool)
    outside[600 - bottom - height : 600 - bottom, left : left + width] = False
    assert (drawn == before)[outside].all()
    assert (drawn != before)[~outside].any()
