"""The card of the first run: four ways to begin."""

from imgui_bundle import imgui

from .. import theme
from ..view import DeskView
from .controls import Ask, button, faint, packed, scale, title

WIDTH = 700.0
NARROWEST = 150.0
"""Of a way; where four do not stand beside each other, two do, or one."""
WAYS = (
    ("camera", "My camera", "Nothing is kept or sent."),
    ("open", "A video or pictures", "Or drop one here."),
    ("demo", "The demo", "A shipped clip."),
    ("open", "An avatar file", "Or drop a .gem here."),
)
LEAVE = "Just watch"


def welcome(view: DeskView, ask: Ask) -> None:
    """At the foot of the picture, so that the face stays free, until one is chosen or Esc is pressed."""
    unit = scale(view)
    room, style = imgui.get_content_region_avail().x, imgui.get_style()
    title("Who should the avatar follow?")
    leave = imgui.calc_text_size(LEAVE).x + 2 * style.frame_padding.x
    if imgui.get_item_rect_size().x + leave + style.item_spacing.x < room:
        imgui.same_line(imgui.get_cursor_start_pos().x + room - leave)
    button(view, ask, "leave", LEAVE)
    faint("A shipped performance plays until you choose. Esc closes this card, ? shows all keys.")
    gap = style.item_spacing.x
    columns = next(n for n in (4, 2, 1) if n == 1 or room - gap * (n - 1) >= n * NARROWEST * unit)
    width, height = (room - gap * (columns - 1)) / columns, 50 * unit
    for index, (name, label, why) in enumerate(WAYS):
        imgui.push_id(index)
        if index % columns:
            imgui.same_line()
        place = imgui.get_cursor_screen_pos()
        pressed = imgui.invisible_button("way", imgui.ImVec2(width, height))
        lit = imgui.is_item_hovered() or imgui.is_item_focused()
        pen = imgui.get_window_draw_list()
        end = imgui.ImVec2(place.x + width, place.y + height)
        pen.add_rect_filled(place, end, packed(theme.FIELD_HOVERED if lit else theme.FIELD), 6 * unit)
        if lit:
            bar = imgui.ImVec2(place.x + 3 * unit, place.y + height)
            pen.add_rect_filled(place, bar, packed(theme.ACCENT), 6 * unit)
        pen.add_text(imgui.ImVec2(place.x + 12 * unit, place.y + 8 * unit), packed(theme.TEXT), label)
        pen.add_text(imgui.ImVec2(place.x + 12 * unit, place.y + 28 * unit), packed(theme.FAINT), why)
        if pressed:
            ask(name, None)
        imgui.pop_id()
