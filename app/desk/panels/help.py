"""Help and menu: the table of actions, with the keys as they are now."""

from imgui_bundle import imgui

from .. import theme
from ..actions import ACTIONS, MENUS
from ..view import DeskView
from .controls import Ask, at_right, button, faint, heading, text, title

WIDTH = 1180.0


def keys_help(view: DeskView, ask: Ask) -> None:
    """All actions with their keys and OSC addresses."""
    title("Keys")
    at_right("Esc closes")
    for conflict in view.keymap.conflicts:
        text(conflict, theme.WARNING)
    faint("Drag on the avatar to turn the camera, the wheel zooms, click on the sketch to follow another face.")
    if imgui.begin_table("help", 3, imgui.TableFlags_.sizing_stretch_same.value):
        for column in (MENUS[:1], MENUS[1:3], MENUS[3:]):
            imgui.table_next_column()
            for menu in column:
                _group(view, menu)
        imgui.end_table()
    faint("OSC: /gemheads/ and the name, by --listen HOST:PORT. Change keys in the settings file.")


def _group(view: DeskView, menu: str) -> None:
    heading(menu)
    if not imgui.begin_table(menu, 2, imgui.TableFlags_.sizing_stretch_prop.value):
        return
    imgui.table_setup_column("what", imgui.TableColumnFlags_.width_stretch.value, 0.6)
    imgui.table_setup_column("keys", imgui.TableColumnFlags_.width_stretch.value, 0.4)
    for action in ACTIONS:
        if action.menu == menu:
            imgui.table_next_row()
            imgui.table_next_column()
            faint(action.title)
            imgui.table_next_column()
            keys = view.keymap.keys_of(action.name)
            text("1 ... 9" if action.name == "avatar" else "  ".join(keys) or "-", theme.TEXT if keys else theme.FAINT)
    imgui.end_table()


def menu(view: DeskView, ask: Ask) -> None:
    """Every action once, in the menu it belongs to."""
    for name in MENUS:
        if imgui.begin_menu(name):
            for action in ACTIONS:
                if action.menu == name:
                    keys = "  ".join(view.keymap.keys_of(action.name))
                    if imgui.menu_item(action.title, "" if action.name == "avatar" else keys, False)[0]:
                        _ask_from_menu(ask, action.name)
            imgui.end_menu()


def _ask_from_menu(ask: Ask, name: str) -> None:
    """A dial needs a value: the menu asks for its resting one."""
    ask(name, RESTING.get(name))


RESTING: dict[str, float] = {
    "avatar": 1,
    "components": 1e6,
    "split": 0.5,
    "explored_component": 0,
    "sigma": 0,
    "seek": 0,
    "step": 1,
    "neutral_strength": 1,
    "smoothing": 0.5,
    "gain_mouth": 1,
    "gain_eyes": 1,
    "gain_brows": 1,
    "gain_head": 1,
    "yaw": 0,
    "pitch": 0,
    "zoom": 1,
    "exposure": 0,
    "warmth": 0,
    "ui_scale": 1,
}
"""What a dial's entry in the menu sets it to: back to where it began."""


def close_button(view: DeskView, ask: Ask, name: str) -> None:
    """Closes what the action of this name opened."""
    button(view, ask, name, "Close", 0.0)
