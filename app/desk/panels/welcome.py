"""The card of the first run: four ways to begin."""

from imgui_bundle import imgui

from .. import theme
from ..view import DeskView
from .controls import Ask, button, faint, packed, scale, text, title

WIDTH = 620.0
NARROW = 480.0
"""Below this the ways stand in one column."""
WAYS = (
    ("camera", "My camera", "No picture of you is kept or sent."),
    ("open", "A video or pictures", "The face in it drives. Or drop it here."),
    ("demo", "The demo", "A shipped clip, to see how it goes."),
    ("open", "An avatar file", "Your own .gem. Or drop it here."),
)


def welcome(view: DeskView, ask: Ask) -> None:
    """At the foot of the picture, so that the face stays free, until one is chosen or Esc is pressed."""
    unit = scale(view)
    title("Who should the avatar follow?")
    faint("It plays a shipped performance by itself until you choose.")
    imgui.dummy(imgui.ImVec2(0, 4 * unit))
    room, gap = imgui.get_content_region_avail().x, imgui.get_style().item_spacing.x
    columns = 1 if room < NARROW * unit else 2
    width, height = (room - gap * (columns - 1)) / columns, 52 * unit
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
        pen.add_text(imgui.ImVec2(place.x + 14 * unit, place.y + 8 * unit), packed(theme.TEXT), label)
        pen.add_text(imgui.ImVec2(place.x + 14 * unit, place.y + 28 * unit), packed(theme.FAINT), why)
        if pressed:
            ask(name, None)
        imgui.pop_id()
    imgui.dummy(imgui.ImVec2(0, 2 * unit))
    button(view, ask, "leave", "Just watch")
    imgui.same_line()
    imgui.align_text_to_frame_padding()
    text("Esc closes this card, ? shows all keys", theme.FAINT)
