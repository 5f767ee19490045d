"""Where everything is: a column at each side, the avatar between them, figures at the foot, cards in the middle."""

from collections.abc import Callable
from dataclasses import dataclass

from imgui_bundle import imgui

from . import theme
from .panels import avatars, curve, driver, explorer, figures, help, notices, prompt, reason, stage, welcome
from .panels.controls import Ask, packed
from .picture import Area
from .view import DeskView

LEFT, RIGHT, FOOT, GAP = 236.0, 272.0, 34.0, 8.0
NARROWEST_PICTURE = 200.0
"""Narrower than this the columns step aside."""
_FIXED = (
    imgui.WindowFlags_.no_decoration.value
    | imgui.WindowFlags_.no_move.value
    | imgui.WindowFlags_.no_saved_settings.value
    | imgui.WindowFlags_.no_focus_on_appearing.value
    | imgui.WindowFlags_.no_bring_to_front_on_focus.value
)
_FIXED |= imgui.WindowFlags_.no_background.value  # the ground is cleared once: filling it again costs llvmpipe 4 ms
_FOOT = _FIXED | imgui.WindowFlags_.no_nav.value  # there is nothing in it to walk to
_COLUMN = _FIXED & ~imgui.WindowFlags_.no_scrollbar.value
_BEHIND = imgui.WindowFlags_.no_bring_to_front_on_focus.value | imgui.WindowFlags_.no_background.value
_CARD = (_COLUMN & ~_BEHIND) | imgui.WindowFlags_.always_auto_resize.value
Panel = Callable[[DeskView, Ask], None]


@dataclass(frozen=True)
class Layout:
    """The parts of a window of some size."""

    picture: Area
    left: Area | None
    right: Area | None
    foot: Area | None


def laid_out(view: DeskView, width: float, height: float) -> Layout:
    """The parts for a window ``width`` x ``height`` pixels; without panels the picture has it all."""
    scale = view.state.ui_scale
    left, right, foot, gap = (length * scale for length in (LEFT, RIGHT, FOOT, GAP))
    columns = view.state.panels and width - left - right - 4 * gap >= NARROWEST_PICTURE * scale
    below = foot + gap if view.state.panels and view.state.figures and height > 4 * foot else 0.0
    tall = max(1.0, height - 2 * gap - below)
    between = Area(left + 2 * gap, gap, width - left - right - 4 * gap, tall)
    return Layout(
        picture=between if columns else Area(0, 0, width, max(1.0, height - below)),
        left=Area(gap, gap, left, tall) if columns else None,
        right=Area(width - gap - right, gap, right, tall) if columns else None,
        foot=Area(gap, height - gap - foot, width - 2 * gap, foot) if below else None,
    )


def covers(view: DeskView, layout: Layout) -> bool:
    """Whether anything lies over the picture, which then cannot be drawn without it."""
    state = view.state
    modes = (
        _records_unseen(view, layout),
        state.welcome,
        state.help,
        state.prompt,
        state.asking_reason,
        state.curve,
        state.menu,
        state.compare,
        state.resting,
    )
    return any(modes) or notices.said(view)


def _records_unseen(view: DeskView, layout: Layout) -> bool:
    """Whether something is recorded while the panel that says so is out of sight."""
    return view.state.record and layout.right is None


class Panels:
    """Draws all panels of a frame; keeps only what imgui needs from one frame to the next."""

    def __init__(self) -> None:
        self._prompt = prompt.Prompt()
        self._reason = reason.Reason()
        self._walked = False

    def draw(self, view: DeskView, ask: Ask, layout: Layout, shown: Area | None) -> None:
        """Draw them; ``shown``: where the picture itself is, None when there is none yet."""
        state = view.state
        walks = state.walking and not self._walked
        self._walked = state.walking
        if not state.walking:
            imgui.push_item_flag(imgui.ItemFlags_.no_tab_stop.value, True)
        middle = avatars.modalities if not state.exploring.on else explorer.explorer
        _column(
            "left",
            layout.left,
            (avatars.avatars, avatars.components, middle, avatars.comparison, stage.stage, avatars.licence),
            view,
            ask,
            walks and not state.menu,
        )
        parts = (driver.driver, driver.neutral, driver.following, stage.outputs)
        _column("right", layout.right, parts, view, ask, False)
        _column("foot", layout.foot, (figures.figures,), view, ask, False)
        area = shown or layout.picture
        if state.compare and shown is not None and not state.curtain:
            notices.comparison(view, area)
        if state.resting:
            notices.countdown(view, area)
        if _records_unseen(view, layout):
            notices.recording(view, area)
        notices.notices(view, area)
        self._cards(view, ask, area)
        if state.menu:
            _menu(view, ask, area)
        if not state.walking:
            imgui.pop_item_flag()

    def _cards(self, view: DeskView, ask: Ask, area: Area) -> None:
        state = view.state
        if state.help or state.writing:
            screen = imgui.get_io().display_size
            shade = packed(theme.GROUND, 0.6)
            imgui.get_background_draw_list().add_rect_filled(imgui.ImVec2(0, 0), screen, shade)
        if state.prompt:  # what is typed into comes first, and goes first with Esc
            _card("prompt", prompt.WIDTH, self._prompt.draw, view, ask, area)
        elif state.asking_reason:
            _card("reason", reason.WIDTH, self._reason.draw, view, ask, area)
        elif state.help:
            _card("help", help.WIDTH, help.keys_help, view, ask, area)
        elif state.curve:
            _card("curve", curve.WIDTH, curve.curve, view, ask, area)
        elif state.welcome:
            _card("welcome", welcome.WIDTH, welcome.welcome, view, ask, area, low=True)


def _column(name: str, area: Area | None, parts: tuple[Panel, ...], view: DeskView, ask: Ask, focus: bool) -> None:
    if area is None:
        return
    imgui.set_next_window_pos(imgui.ImVec2(area.left, area.top))
    imgui.set_next_window_size(imgui.ImVec2(area.width, area.height))
    if focus:
        imgui.set_next_window_focus()
    imgui.begin(name, None, _FOOT if name == "foot" else _COLUMN)
    for part in parts:
        part(view, ask)
    imgui.end()


def _card(name: str, width: float, panel: Panel, view: DeskView, ask: Ask, area: Area, low: bool = False) -> None:
    """In the middle of the picture, or ``low`` at its foot; where it is wider than that, of the window."""
    scale, screen = view.state.ui_scale, imgui.get_io().display_size
    width, tallest = min(width * scale, screen.x - 2 * GAP), screen.y - 2 * GAP
    part = 1.0 if low else 0.5
    place = imgui.ImVec2(area.left + area.width / 2, area.top + GAP + (area.height - 2 * GAP) * part)
    if width > area.width:
        place = imgui.ImVec2(screen.x / 2, GAP + (screen.y - 2 * GAP) * part)
    imgui.set_next_window_pos(place, imgui.Cond_.always.value, imgui.ImVec2(0.5, part))
    imgui.set_next_window_size_constraints(imgui.ImVec2(width, 0), imgui.ImVec2(width, tallest))
    imgui.begin(name, None, _CARD)
    if imgui.is_window_appearing():
        imgui.set_window_focus()
    panel(view, ask)
    imgui.end()


def _menu(view: DeskView, ask: Ask, area: Area) -> None:
    """A card at the picture's corner: unlike a bar, arrows reach it."""
    imgui.set_next_window_pos(imgui.ImVec2(area.left + GAP, area.top + GAP))
    imgui.begin("menu", None, _CARD)
    if imgui.is_window_appearing():
        imgui.set_window_focus()
    help.menu(view, ask)
    imgui.end()
