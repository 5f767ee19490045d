"""Help and menu: the table of actions, with the keys as they are now."""

from imgui_bundle import imgui

from ....models.gem import MODALITIES
from .. import theme
from ..actions import ACTIONS, MENUS
from ..state import SWITCHES
from ..view import DeskView
from .controls import Ask, at_right, faint, heading, text, title

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
    """Every action once, in the menu it belongs to; what is on is ticked."""
    for name in MENUS:
        if imgui.begin_menu(name):
            for action in ACTIONS:
                if action.menu == name:
                    keys = "  ".join(view.keymap.keys_of(action.name))
                    title, value = RESTING.get(action.name, (action.title, None))
                    if imgui.menu_item(title, "" if action.name == "avatar" else keys, is_on(view, action.name))[0]:
                        ask(action.name, value)
            imgui.end_menu()


def is_on(view: DeskView, name: str) -> bool:
    """Whether an action is a switch that is on."""
    state = view.state
    return {
        **{switch: bool(getattr(state, switch)) for switch in (*SWITCHES, "error_map")},
        **{modality: modality not in state.off for modality in MODALITIES},
        "explore": state.exploring.on,
        "sweep": state.exploring.on and state.exploring.sweep,
        "badge": not state.no_badge,
    }.get(name, False)


RESTING: dict[str, tuple[str, float]] = {
    "avatar": ("The first avatar", 1),
    "components": ("All components", 1e6),
    "split": ("Split of the comparison: middle", 0.5),
    "explored_component": ("The first component", 0),
    "sigma": ("Explored component: at rest", 0),
    "seek": ("To the beginning of the source", 0),
    "step": ("One frame on", 1),
    "neutral_strength": ("Strength of the neutral: whole", 1),
    "smoothing": ("Smoothing: back to 0.50", 0.5),
    "gain_mouth": ("Gain of the mouth: back to 1", 1),
    "gain_eyes": ("Gain of the eyes: back to 1", 1),
    "gain_brows": ("Gain of the brows: back to 1", 1),
    "gain_head": ("Gain of the head: back to 1", 1),
    "yaw": ("Camera: in front of the face", 0),
    "pitch": ("Camera: level with the face", 0),
    "zoom": ("Zoom: back to 1", 1),
    "exposure": ("Light on the avatar: as it was made", 0),
    "warmth": ("Warmth of the light: as it was made", 0),
    "ui_scale": ("Size of text and panels: back to 1", 1),
}
"""What a dial's entry in the menu is called, and sets it to: back to where it began."""
