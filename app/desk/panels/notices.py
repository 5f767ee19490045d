"""What is said over the picture: what is wrong and its cure, messages that pass, countdown, curtain, comparison."""

from collections.abc import Iterator

from imgui_bundle import imgui

from .. import theme
from ..picture import Area
from ..theme import Colour
from ..view import DeskView
from .controls import packed, scale


def notices(view: DeskView, picture: Area) -> None:
    """Pills at the foot of the picture, the newest at the bottom; at its head while a card lies at the foot."""
    pen, unit = imgui.get_foreground_draw_list(), scale(view)
    if view.state.welcome:
        top = picture.top + 14 * unit
        for words, ink in _sentences(view):
            top += _pill(pen, words, ink, picture, top, unit, hangs=True) + 8 * unit
        return
    bottom = picture.top + picture.height - 14 * unit
    for words, ink in reversed(list(_sentences(view))):
        bottom -= _pill(pen, words, ink, picture, bottom, unit) + 8 * unit


def said(view: DeskView) -> bool:
    """Whether there is anything to say."""
    return any(_sentences(view))


def comparison(view: DeskView, picture: Area) -> None:
    """The line between the two halves, and what each shows."""
    pen, unit, state = imgui.get_background_draw_list(), scale(view), view.state
    x = picture.left + picture.width * state.split
    top, bottom = picture.top, picture.top + picture.height
    pen.add_line(imgui.ImVec2(x, top), imgui.ImVec2(x, bottom), packed(theme.ACCENT), 2 * unit)
    pen.add_circle_filled(imgui.ImVec2(x, (top + bottom) / 2), 9 * unit, packed(theme.ACCENT))
    left = f"A: all {state.limits.components}"
    used = max(state.used_components, state.explored_components)
    right = "error x 8" if state.error_map else f"B: {used} components"
    away, pad = 12 * unit, 8 * unit
    for words, at in ((left, x - away - imgui.calc_text_size(left).x - 2 * pad), (right, x + away)):
        size = imgui.calc_text_size(words)  # on a ground of its own: the accent alone is lost on a green screen
        corner = imgui.ImVec2(at + size.x + 2 * pad, top + away + size.y + pad)
        pen.add_rect_filled(imgui.ImVec2(at, top + away), corner, packed(theme.PANEL, 0.92), pad)
        pen.add_text(imgui.ImVec2(at + pad, top + away + pad / 2), packed(theme.ACCENT), words)


def recording(view: DeskView, picture: Area) -> None:
    """A dot at the picture's corner, in the window alone: what is recorded has nothing on it."""
    pen, unit = imgui.get_foreground_draw_list(), scale(view)
    middle = imgui.ImVec2(picture.left + 24 * unit, picture.top + 24 * unit)
    pen.add_circle_filled(middle, 12 * unit, packed(theme.PANEL, 0.92))
    pen.add_circle_filled(middle, 7 * unit, packed(theme.ALARM))


def countdown(view: DeskView, picture: Area) -> None:
    """The seconds until the neutral is taken, large; then how much of it is there."""
    rest, unit = view.rest, scale(view)
    pen = imgui.get_foreground_draw_list()
    middle = imgui.ImVec2(picture.left + picture.width / 2, picture.top + 56 * unit)
    pen.add_circle_filled(middle, 34 * unit, packed(theme.PANEL, 0.85))
    ink = packed(theme.ACCENT if rest.green else theme.WARNING)
    if rest.progress is not None:
        pen.path_arc_to(middle, 30 * unit, -1.5708, -1.5708 + 6.2832 * rest.progress, 48)
        pen.path_stroke(ink, 4 * unit)
    words = f"{rest.countdown:.0f}" if rest.countdown is not None else ("hold" if rest.green else "...")
    size = imgui.calc_text_size(words)
    pen.add_text(imgui.ImVec2(middle.x - size.x / 2, middle.y - size.y / 2), ink, words)


def _sentences(view: DeskView) -> Iterator[tuple[str, Colour]]:
    health, state = view.health, view.state
    if state.curtain:
        yield "Curtain: nothing of the avatar is shown or sent. 0 lifts it.", theme.ACCENT
    elif state.frozen:
        yield "Frozen. Space lets it go on.", theme.ACCENT
    elif health.message:
        ink = theme.ALARM if health.phase == "stalled" else theme.WARNING
        yield f"{health.message} {health.cure}".strip(), ink
    if state.resting:
        yield " ".join(view.rest.sentences) or "Look into the camera, face at rest.", theme.WARNING
    if view.loading:
        first = "" if view.avatar.name else " The very first start compiles what draws, which takes up to a minute."
        yield f"Loading {view.loading} ...{first}", theme.FAINT
    for toast in view.toasts:
        yield toast.text, theme.ALARM if toast.alarm else theme.TEXT


def _pill(
    pen: imgui.ImDrawList, words: str, ink: Colour, picture: Area, edge: float, unit: float, hangs: bool = False
) -> float:
    """Draws words centred above ``edge``, or below it when it ``hangs``, wrapped to the picture; returns its height."""
    widest = max(160 * unit, min(picture.width - 48 * unit, 560 * unit))
    size = imgui.calc_text_size(words, False, widest)
    pad_x, pad_y = 14 * unit, 8 * unit
    left = picture.left + (picture.width - size.x) / 2 - pad_x
    height = size.y + 2 * pad_y
    top = edge if hangs else edge - height
    corner = imgui.ImVec2(left + size.x + 2 * pad_x, top + height)
    pen.add_rect_filled(imgui.ImVec2(left, top), corner, packed(theme.PANEL, 0.92), 8 * unit)
    at = imgui.ImVec2(left + pad_x, top + pad_y)
    pen.add_text(imgui.get_font(), imgui.get_font_size(), at, packed(ink), words, widest)
    return height
