from pathlib import Path

from gemheads.app.desk.actions import ACTIONS, BY_NAME, MENUS, Order
from gemheads.app.desk.keys import key_name, keymap, rebound
from gemheads.app.desk.panels.help import RESTING
from gemheads.app.desk.session import TRANSPORT
from gemheads.app.desk.state import DeskState, Exploring, update

SPECIFIED = {
    **{str(n): "avatar" for n in range(1, 10)},
    "A": "previous_avatar",
    "D": "next_avatar",
    "+": "components",
    "-": "components",
    "0": "curtain",
    "N": "neutral",
    "Space": "play",
    ",": "step",
    ".": "step",
    "R": "record",
    "P": "picture",
    "V": "virtual_camera",
    "B": "compare",
    "M": "mirror",
    "L": "relock",
    "F": "frame",
    "Home": "reset_view",
    "I": "figures",
    "Tab": "panels",
    "?": "help",
    "Esc": "leave",
    "Ctrl+Q": "quit",
}
"""The keys of the specification."""


def test_every_action_has_a_key_a_menu_a_title_and_an_address() -> None:
    assert len(BY_NAME) == len(ACTIONS)
    keys = keymap()
    assert not keys.conflicts
    for action in ACTIONS:
        assert keys.keys_of(action.name), action.name
        assert all(key_name(key) == key for key, _ in action.keys)
        assert action.menu in MENUS
        assert action.title
        assert action.osc == f"/gemheads/{action.name}"


def test_the_keys_are_those_of_the_specification() -> None:
    keys = keymap()
    for key, name in SPECIFIED.items():
        order = keys.order(key)
        assert order is not None
        assert order.name == name
    assert keys.order("+") == Order("components", 5, relative=True)
    assert keys.order("3") == Order("avatar", 3.0)


def test_every_dial_has_a_place_to_go_back_to_from_the_menu() -> None:
    dials = {action.name for action in ACTIONS if action.argument == "number"}
    assert dials == set(RESTING)


def test_every_action_does_something() -> None:
    """It changes the state, but for what the session carries out."""
    carried_out = {*TRANSPORT, "avatar", "previous_avatar", "next_avatar", "no_source", "relock", "picture"}
    values = [None, 0.0, 0.3, 2.0, 12.0, "white", "scale", "a.gem"]
    before = DeskState(yaw=3, zoom=2, exploring=Exploring(sigmas=(("scale", 1, 1.0),)))
    idle = {
        action.name
        for action in ACTIONS
        if all(update(before, Order(action.name, value)) == before for value in values)
    }
    assert idle == carried_out - {"play"}  # which freezes the picture, where nothing can be paused


def test_keys_are_called_by_one_name_however_they_are_written() -> None:
    assert key_name(" ctrl + q ") == "Ctrl+Q"
    assert key_name("shift+ctrl+pageup") == "Ctrl+Shift+PageUp"
    assert key_name("ctrl++") == "Ctrl++"
    assert key_name("+") == "+"
    for nonsense in ("", "  ", "Hyper+X", "word", "Ctrl+"):
        assert key_name(nonsense) is None


def test_held_down_a_key_repeats_only_what_moves_by_steps() -> None:
    keys = keymap()
    assert keys.order("+", repeated=True) is not None
    assert keys.order("R", repeated=True) is None


def test_a_rebound_key_moves_and_what_lost_its_key_is_named() -> None:
    keys = keymap({"record": ("M",)})
    order = keys.order("M")
    assert order is not None
    assert order.name == "record"
    assert keys.order("R") is None
    assert keys.keys_of("mirror") == ()
    assert keys.conflicts == ("M means Record, so Mirror the preview is left without it.",)


def test_keys_beyond_those_that_an_action_takes_are_named() -> None:
    (said,) = keymap({"record": ["F9", "F8"]}).conflicts
    assert said == "Record takes 1 of your keys; 'F8' is one too many."


def test_nobody_can_lock_themselves_in() -> None:
    keys = keymap({"quit": ("F5",), "mirror": ("Ctrl+Q",), "leave": ("nonsense",), "no such": ("Z",)})
    for key, name in (("Ctrl+Q", "quit"), ("Esc", "leave"), ("F5", "quit")):
        order = keys.order(key)
        assert order is not None
        assert order.name == name
    assert len(keys.conflicts) == 3


def test_one_of_two_keys_can_be_changed() -> None:
    changes = rebound({}, "components", 1, "#")
    keys = keymap(changes)
    assert keys.keys_of("components") == ("-", "#")
    assert keys.order("#") == Order("components", 5, relative=True)
    assert keymap(rebound(changes, "components", 0, "~")).keys_of("components") == ("~", "#")


def test_the_manual_has_every_action_as_it_is() -> None:
    manual = (Path(__file__).parents[3] / "docs" / "live.md").read_text()
    for action in ACTIONS:
        row = next(line for line in manual.splitlines() if f"| `{action.osc}` |" in line)
        assert action.title in row
        assert row.startswith(f"| {action.menu} |")
        assert row.endswith(f"| {action.argument} |")
        assert action.name == "avatar" or all(f"`{key}`" in row for key, _ in action.keys)
