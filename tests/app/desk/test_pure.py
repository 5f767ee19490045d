"""What is computed on the way to the picture, each against what it must mean."""

import numpy as np
import pytest
from gemheads.app.desk import explore
from gemheads.app.desk.compare import EXACT_DB, decibels, heat, joined
from gemheads.app.desk.layout import laid_out
from gemheads.app.desk.light import lit
from gemheads.app.desk.measuring import counts_of, curve_of, megabytes
from gemheads.app.desk.picture import Area
from gemheads.app.desk.roster import Roster
from gemheads.app.desk.state import DeskState, Exploring
from gemheads.app.desk.view import DeskView
from gemheads.app.live import NO_SHIFT
from gemheads.app.performing.performance import Pose
from gemheads.models.gem import Gem
from gems import ball


def test_a_slider_adds_its_sigmas_and_nothing_else(tiny_gem: Gem) -> None:
    state = DeskState(exploring=Exploring(on=True, sigmas=(("rotation", 1, 2.0),)))
    pose = Pose(tiny_gem.rest_coefficients, NO_SHIFT)
    change = explore.posed(tiny_gem, pose, state, 0.0).coefficients - tiny_gem.clamped(pose.coefficients)
    index = tiny_gem.slices["rotation"].start + 1
    assert change[index] == pytest.approx(2 * tiny_gem.sigma[index])
    assert np.count_nonzero(change) == 1


def test_a_sweep_goes_to_three_sigma_on_both_sides_and_stays_on_its_component(tiny_gem: Gem) -> None:
    exploring = Exploring(on=True, modality="scale", component=0, sweep=True)
    index = tiny_gem.slices["scale"].start
    at = np.array([explore.nudge(tiny_gem, exploring, t)[index] for t in np.linspace(0, explore.SWEEP_SECS, 401)])
    assert at.max() == pytest.approx(3 * tiny_gem.sigma[index])
    assert at.min() == pytest.approx(-3 * tiny_gem.sigma[index])


def test_components_that_an_avatar_does_not_have_are_left_out(tiny_gem: Gem) -> None:
    exploring = Exploring(on=True, sigmas=(("opacity", 0, 1.0), ("position", 99, 1.0)))
    assert not explore.nudge(tiny_gem, exploring, 0.0).any()


def test_a_modality_that_is_off_stays_at_rest(tiny_gem: Gem) -> None:
    moved = Pose(tiny_gem.rest_coefficients + 1, NO_SHIFT)
    still = explore.posed(tiny_gem, moved, DeskState(off=frozenset({"position"})), 0.0).coefficients
    part = tiny_gem.slices["position"]
    np.testing.assert_array_equal(still[part], tiny_gem.rest_coefficients[part])
    np.testing.assert_array_equal(np.delete(still, np.r_[part]), np.delete(moved.coefficients, np.r_[part]))
    assert explore.posed(tiny_gem, moved, DeskState(), 0.0) is moved


def test_light_is_stops_and_warmth_moves_red_against_blue() -> None:
    colors = np.full((4, 3), 0.4, np.float32)
    assert lit(colors, 0, 0) is colors
    np.testing.assert_allclose((lit(colors, 1, 0) / colors) ** 2.2, 2.0, rtol=1e-5)
    red, green, blue = lit(colors, 0, 1)[0]
    assert red > green > blue
    assert lit(colors, 9, 0).max() == 1.0


def test_the_comparison_shows_a_to_the_left_and_the_error_where_they_differ() -> None:
    a = np.zeros((4, 10, 3), np.uint8)
    b = a.copy()
    b[:, 7] = 20
    both = joined(a, b, 0.5)
    assert (both[:, :5] == a[:, :5]).all()
    assert (both[:, 5:] == b[:, 5:]).all()
    error = heat(a, b)
    assert (error[:, 7] != error[:, 0]).any(axis=1).all()
    assert (error[:, :7] == error[0, 0]).all()
    assert decibels(a, a) == EXACT_DB
    assert decibels(a, b) == pytest.approx(10 * np.log10(255**2 / 40))


def test_the_curve_rises_with_the_components_and_knows_what_they_cost() -> None:
    gem = ball()
    curve = curve_of(gem)
    assert curve is not None
    assert curve_of(gem, ended=lambda: True) is None
    assert tuple(curve.components) == counts_of(gem) == (1, 2, 3, 5, 6)
    assert curve.decibels[-1] == EXACT_DB
    assert curve.decibels[0] < curve.decibels[-2] < EXACT_DB
    assert np.diff(curve.megabytes).min() > 0
    assert megabytes(gem, 6) == pytest.approx(sum(basis.rows.nbytes for basis in gem.bases.values()) / 1e6)


def test_a_picture_keeps_its_proportions_and_its_middle() -> None:
    inner = Area(100, 50, 400, 300).fitted(512, 512)
    assert (inner.width, inner.height) == (300, 300)
    assert (inner.left, inner.top) == (150, 50)
    assert inner.holds(150, 50)
    assert not inner.holds(149, 50)


@pytest.mark.parametrize("size", [(1280, 800), (640, 480), (360, 300), (3840, 2160), (1, 1)])
@pytest.mark.parametrize("scale", [0.75, 2.5])
def test_the_layout_fits_any_window(size: tuple[int, int], scale: float) -> None:
    for state in (DeskState(ui_scale=scale), DeskState(ui_scale=scale, panels=False), DeskState(menu=True)):
        layout = laid_out(DeskView(state=state), *size)
        assert layout.picture.width > 0
        assert layout.picture.height > 0
        if layout.left is not None and layout.right is not None:
            assert layout.left.left + layout.left.width <= layout.picture.left
            assert layout.picture.left + layout.picture.width <= layout.right.left
            assert layout.right.left + layout.right.width <= size[0]


def test_avatars_go_round_and_new_ones_come_last(tmp_path) -> None:
    roster = Roster((tmp_path / "a.gem", tmp_path / "b.gem"))
    assert roster.beside(-1) == tmp_path / "b.gem"
    assert roster.numbered(3) is None
    roster = roster.staged(tmp_path / "c.gem")
    assert roster.names == ("a", "b", "c")
    assert roster.current == 2
    assert roster.numbered(3) == tmp_path / "c.gem"
    assert Roster(()).beside(1) is None
