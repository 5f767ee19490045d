"""The few controls that all panels are made of; each asks by an action's name and says its keys."""

from collections.abc import Callable

from imgui_bundle import imgui

from .. import theme
from ..actions import BY_NAME
from ..theme import Colour
from ..view import DeskView

Ask = Callable[[str, float | str | None], None]
"""Asks for an action, with a value that replaces what is there."""
LABEL_SHARE = 0.29
"""Of a row's width, for what stands before a slider."""
VALUE_SHARE = 0.27
"""Of a row's width, for the number behind it."""


def scale(view: DeskView) -> float:
    """Pixels for each unit of the design."""
    return view.state.ui_scale


def colour(value: Colour) -> imgui.ImVec4:
    """A colour as imgui takes it."""
    return imgui.ImVec4(*value)


def packed(value: Colour, alpha: float = 1.0) -> int:
    """A colour as draw lists take it."""
    return imgui.get_color_u32(imgui.ImVec4(*value[:3], value[3] * alpha))


def text(words: str, ink: Colour = theme.TEXT) -> None:
    """Text that wraps at the panel's edge."""
    imgui.push_text_wrap_pos(0.0)
    imgui.push_style_color(imgui.Col_.text, colour(ink))
    imgui.text_unformatted(words)
    imgui.pop_style_color()
    imgui.pop_text_wrap_pos()


def faint(words: str) -> None:
    """Text that matters less."""
    text(words, theme.FAINT)


def title(words: str) -> None:
    """The title of a card."""
    imgui.push_font(_strong(), 20.0)
    imgui.text_unformatted(words)
    imgui.pop_font()


def heading(words: str, aside: str = "") -> None:
    """The title of a section, with something short at the right edge."""
    imgui.push_style_color(imgui.Col_.text, colour(theme.TEXT))
    imgui.push_font(_strong(), 0.0)
    imgui.text_unformatted(words)
    imgui.pop_font()
    imgui.pop_style_color()
    if aside:
        at_right(aside)


def at_right(words: str, ink: Colour = theme.FAINT) -> None:
    """Text at the right edge of the row."""
    imgui.same_line()
    room = imgui.get_content_region_avail().x - imgui.calc_text_size(words).x
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(0.0, room))
    imgui.push_style_color(imgui.Col_.text, colour(ink))
    imgui.text_unformatted(words)
    imgui.pop_style_color()


def rule(view: DeskView) -> None:
    """A thin line between sections."""
    imgui.separator()


def hint(view: DeskView, name: str) -> None:
    """On what stands above: the action's title and its keys, when the pointer rests there."""
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip.value):
        keys = "  ".join(view.keymap.keys_of(name))
        imgui.set_tooltip(f"{BY_NAME[name].title}    {keys}" if keys else BY_NAME[name].title)


def dial(view: DeskView, ask: Ask, name: str, label: str, value: float, low: float, high: float, form: str) -> None:
    """A labelled slider over the whole width."""
    row = imgui.get_content_region_avail().x
    imgui.align_text_to_frame_padding()
    imgui.push_style_color(imgui.Col_.text, colour(theme.FAINT))
    imgui.text_unformatted(label)
    imgui.pop_style_color()
    left = imgui.get_cursor_start_pos().x
    imgui.same_line(left + row * LABEL_SHARE)
    changed, after = bar(f"##{name}", value, low, high, row * (1 - LABEL_SHARE - VALUE_SHARE))
    hint(view, name)
    at_right(form % value)
    if changed:
        ask(name, after)


def bar(name: str, value: float, low: float, high: float, width: float) -> tuple[bool, float]:
    """A slider without a number on it; Ctrl and a click type one. Whether it moved, and where to."""
    imgui.set_next_item_width(width)
    flags = imgui.SliderFlags_.always_clamp.value
    return imgui.slider_float(name, value, low, high, "", flags)


def switch(view: DeskView, ask: Ask, name: str, label: str, on: bool) -> None:
    """A box to tick."""
    changed, after = imgui.checkbox(f"{label}##{name}", on)
    hint(view, name)
    if changed:
        ask(name, float(after))


def button(
    view: DeskView,
    ask: Ask,
    name: str,
    label: str,
    value: float | str | None = None,
    width: float = 0.0,
    lit: bool = False,
) -> None:
    """A button; ``lit`` in the accent colour while what it does is on."""
    if lit:
        imgui.push_style_color(imgui.Col_.button, colour(theme.ACCENT))
        imgui.push_style_color(imgui.Col_.button_hovered, colour(theme.ACCENT_HOVERED))
        imgui.push_style_color(imgui.Col_.text, colour(theme.ON_ACCENT))
    pressed = imgui.button(f"{label}##{name}{value}", imgui.ImVec2(width, 0))
    if lit:
        imgui.pop_style_color(3)
    hint(view, name)
    if pressed:
        ask(name, value)


def columns(count: int) -> float:
    """Width of each of so many buttons side by side in what is left of the row."""
    gaps = imgui.get_style().item_spacing.x * (count - 1)
    return (imgui.get_content_region_avail().x - gaps) / count


def meter(view: DeskView, share: float, ink: Colour) -> None:
    """A thin bar that is filled to a share in [0, 1]."""
    place, width, height = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x, 4 * scale(view)
    pen = imgui.get_window_draw_list()
    end = imgui.ImVec2(place.x + width, place.y + height)
    pen.add_rect_filled(place, end, packed(theme.FIELD), height / 2)
    if share > 0:
        filled = imgui.ImVec2(place.x + max(height, width * min(1.0, share)), place.y + height)
        pen.add_rect_filled(place, filled, packed(ink), height / 2)
    imgui.dummy(imgui.ImVec2(width, height))


def _strong() -> imgui.ImFont:
    fonts = imgui.get_io().fonts.fonts
    return fonts[len(fonts) - 1]
