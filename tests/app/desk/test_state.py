from dataclasses import replace

import pytest
from gemheads.app.desk.actions import ACTIONS, Order
from gemheads.app.desk.state import BACKGROUNDS, RANGES, DeskState, Exploring, Limits, restaged, update
from hypothesis import given
from hypothesis import strategies as st

VALUES = st.one_of(st.none(), st.floats(), st.integers(-1000, 1000), st.text(max_size=9), st.sampled_from(BACKGROUNDS))
ORDERS = st.builds(Order, st.sampled_from([action.name for action in ACTIONS]), VALUES, st.booleans())


@given(st.lists(ORDERS, max_size=30))
def test_whatever_is_asked_for_the_state_stays_within_its_limits(orders: list[Order]) -> None:
    state = DeskState(limits=Limits(20, 40.0, 20.0))
    for order in orders:
        state = update(state, order)
    for name, (low, high) in RANGES.items():
        assert low <= getattr(state, name) <= high
    assert 1 <= state.used_components <= 20
    assert abs(state.yaw) <= 40
    assert abs(state.pitch) <= 20
    assert 0 <= state.exploring.component < 20
    assert all(-3 <= value <= 3 for *_, value in state.exploring.sigmas)
    assert isinstance(state.curtain, bool)


@pytest.mark.parametrize("name", ["compare", "mirror", "curtain", "record", "panels", "help", "menu", "ladder"])
def test_a_switch_toggles_without_a_value_and_is_set_by_one(name: str) -> None:
    before = DeskState()
    once = update(before, Order(name))
    assert getattr(once, name) is not getattr(before, name)
    assert update(once, Order(name)) == before
    assert getattr(update(before, Order(name, 1.0)), name) is True
    assert getattr(update(before, Order(name, 0.0)), name) is False


def test_the_badge_goes_only_with_a_reason_and_comes_back_without_one() -> None:
    asked = update(DeskState(), Order("badge"))
    assert asked.asking_reason
    assert not asked.no_badge
    assert update(asked, Order("leave")) == DeskState()
    assert update(asked, Order("badge", "because")) == asked
    away = update(asked, Order("badge", "  the channel says\nso itself "))
    assert (away.no_badge, away.asking_reason) == ("the channel says so itself", False)
    for value in (None, 1.0):
        assert update(away, Order("badge", value)) == DeskState()
    assert update(DeskState(), Order("badge", 0.0)) == asked
    assert update(DeskState(), Order("badge", 1.0)) == DeskState()


def test_components_go_by_fives_between_one_and_all() -> None:
    state = DeskState(limits=Limits(components=12))
    seen = []
    for step in (-5, -5, -5, 5, 5, 5, 5):
        state = update(state, Order("components", step, relative=True))
        seen.append(state.used_components)
    assert seen == [7, 2, 1, 5, 10, 12, 12]
    assert state.components is None


def test_the_camera_stops_where_the_avatar_was_made_to_be_seen_from_and_says_so() -> None:
    state = update(DeskState(), Order("yaw", 44, relative=False))
    assert not state.at_limit
    state = update(state, Order("yaw", 5, relative=True))
    assert state.yaw == 45
    assert state.at_limit
    assert not update(state, Order("yaw", -5, relative=True)).at_limit
    assert update(state, Order("reset_view")).yaw == 0


def test_another_avatar_draws_in_what_only_the_old_one_allowed() -> None:
    state = DeskState(components=40, yaw=40, exploring=Exploring(sigmas=(("scale", 39, 1.0),), component=39))
    after = restaged(state, Limits(20, 30.0, 10.0))
    assert after.used_components == 20
    assert after.yaw == 30
    assert after.exploring.sigmas == ()
    assert after.exploring.component == 0


def test_escape_leaves_one_mode_at_a_time_the_topmost_first() -> None:
    state = DeskState(help=True, compare=True, exploring=Exploring(on=True), welcome=True)
    order = Order("leave")
    state = update(state, order)
    assert not state.help
    assert state.compare
    state = update(state, order)
    assert not state.compare
    assert state.exploring.on
    state = update(state, order)
    assert not state.exploring.on
    assert state.welcome
    state = update(state, order)
    assert not state.welcome
    assert update(state, order) == state
    assert not state.quitting


def test_exploring_a_slider_turns_the_explorer_on() -> None:
    state = update(DeskState(), Order("explored_modality", "rotation"))
    state = update(state, Order("explored_component", 4.0))
    state = update(state, Order("sigma", 0.25, relative=True))
    state = update(state, Order("sigma", 9.0, relative=True))
    assert state.exploring.on
    assert state.exploring.sigmas == (("rotation", 4, 3.0),)
    assert update(state, Order("sigma", 0.0)).exploring.sigmas == ()
    assert update(state, Order("unexplore")).exploring.sigmas == ()


def test_only_what_is_stored_is_explored() -> None:
    """Imported avatars have no components of the opacity, and others fewer of one modality than of another."""
    limits = Limits(20, stored={"position": 20, "rotation": 20, "scale": 6, "opacity": 0})
    state = DeskState(limits=limits)
    for order, explored in (
        (Order("explored_component", 99.0), ("position", 19, False)),
        (Order("sweep"), ("position", 19, True)),
        (Order("explored_modality", "scale"), ("scale", 5, True)),
        (Order("explored_component", 1.0, relative=True), ("scale", 5, True)),
        (Order("explored_modality", "opacity"), ("opacity", 0, False)),
        (Order("sweep", 1.0), ("opacity", 0, False)),
        (Order("sigma", 1.0), ("opacity", 0, False)),
    ):
        state = update(state, order)
        assert (state.exploring.modality, state.exploring.component, state.exploring.sweep) == explored
        assert state.exploring.sigmas == ()
    swept = DeskState(exploring=Exploring(on=True, modality="opacity", sweep=True))
    assert not restaged(swept, limits).exploring.sweep


def test_the_explorer_needs_as_many_components_as_it_moves() -> None:
    state = DeskState(limits=Limits(20), components=3)
    assert state.explored_components == 0
    moved = Exploring(on=True, component=4, sigmas=(("scale", 9, 1.0),))
    assert replace(state, exploring=replace(moved, sigmas=())).explored_components == 5
    assert replace(state, exploring=moved).explored_components == 10
    assert replace(state, exploring=replace(moved, component=99)).explored_components == 20


def test_backgrounds_go_round_and_colours_are_taken() -> None:
    state = DeskState()
    for name in (*BACKGROUNDS[1:], BACKGROUNDS[0]):
        state = update(state, Order("background"))
        assert state.background == name
    assert update(state, Order("background", "#10fF00")).background == "#10ff00"
    assert update(state, Order("background", "no colour")) == state


def test_what_is_unknown_changes_nothing() -> None:
    state = DeskState()
    assert update(state, Order("format the disk")) == state
    assert update(state, Order("zoom", float("nan"))) == state
    assert update(state, Order("zoom", 10**400)) == state
    assert update(state, Order("zoom", "large")) == state
    assert update(replace(state, zoom=2.0), Order("components", None)).zoom == 2.0


def test_the_error_map_brings_the_comparison_that_it_is_seen_in() -> None:
    state = update(DeskState(), Order("error_map"))
    assert state.compare
    assert state.error_map
    hidden = update(state, Order("compare"))
    assert update(hidden, Order("error_map")).compare
    assert not update(state, Order("error_map")).error_map
