"""The driver: where the face comes from, what is seen of it, and how it is followed."""

from imgui_bundle import imgui

from .. import theme
from ..theme import Colour
from ..view import DeskView
from .controls import (
    Ask,
    at_right,
    bar,
    button,
    columns,
    dial,
    faint,
    heading,
    hint,
    meter,
    packed,
    rule,
    scale,
    switch,
    text,
)

PHASES: dict[str, tuple[str, Colour]] = {
    "no source": ("No source", theme.FAINT),
    "opening": ("Opening", theme.WARNING),
    "searching": ("Looking for you", theme.WARNING),
    "tracking": ("Tracking", theme.ACCENT),
    "hold": ("Holding", theme.WARNING),
    "idle": ("Idle", theme.FAINT),
    "stalled": ("Source stalled", theme.ALARM),
}
SKETCH_HEIGHT = 112.0
DANGER = 0.15
"""Share of clamped coefficients from which the meter turns: the driver leaves what the avatar learned."""


def driver(view: DeskView, ask: Ask) -> None:
    """Right column: source, sketch, status."""
    health = view.health
    words, ink = PHASES[health.phase]
    heading("Driver")
    at_right(words, ink)
    _choose_source(view, ask)
    _sketch(view, ask)
    if view.transport is not None:
        _transport(view, ask)
    observed = view.shot.observed if view.shot is not None else None
    size = "{}x{}".format(*observed.picture_size) if observed is not None else ""
    rate = f"{health.rate:.0f} per second" if health.rate else ""
    skipped = f"{health.drops} skipped" if health.drops else ""
    if size or rate or skipped:
        faint(", ".join(part for part in (size, rate, skipped) if part))
    for sentence in (*(f"{health.message} {health.cure}".strip(),), *health.hints):
        if sentence:
            text(sentence, theme.WARNING)


def following(view: DeskView, ask: Ask) -> None:
    """Right column: smoothing, gains, and whether the avatar can still follow."""
    state = view.state
    rule(view)
    heading("Following")
    dial(view, ask, "smoothing", "Smoothing", state.smoothing, 0, 1, "%.2f")
    for part in ("mouth", "eyes", "brows", "head"):
        name = f"gain_{part}"
        dial(view, ask, name, part.capitalize(), getattr(state, name), 0, 2, "x %.2f")
    switch(view, ask, "head_pose", "Head follows", state.head_pose)
    clamped = view.shot.pose.clamped if view.shot is not None else 0.0
    at_right(f"{clamped:.0%} at the limit", theme.ALARM if clamped > DANGER else theme.FAINT)
    meter(view, clamped, theme.ALARM if clamped > DANGER else theme.ACCENT)
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip.value):
        imgui.set_tooltip("Coefficients at 3 sigma: when many are, the face does what the avatar never learned.")


def neutral(view: DeskView, ask: Ask) -> None:
    """Right column: the face at rest that everything is measured from."""
    rule(view)
    score = view.rest.score
    heading("Neutral", f"score {score:.2f}" if score is not None else "")
    if view.rest.result or view.health.neutral:
        faint(view.rest.result or view.health.neutral)
    label = "Stop" if view.state.resting else "Take it: look at rest"
    button(view, ask, "neutral", label, width=-1, lit=view.state.resting)
    dial(view, ask, "neutral_strength", "Strength", view.state.neutral_strength, 0, 1, "%.2f")


def _choose_source(view: DeskView, ask: Ask) -> None:
    imgui.set_next_item_width(-1)
    if imgui.begin_combo("##source", view.health.source or "Choose a source"):
        for name in view.cameras:
            if imgui.selectable(f"Camera: {name}", name == view.health.source)[0]:
                ask("camera", name)
        for name, label in (
            ("camera", "My camera"),
            ("demo", "The demo"),
            ("open", "A file ..."),
            ("no_source", "None"),
        ):
            if (name != "camera" or not view.cameras) and imgui.selectable(label, False)[0]:
                ask(name, None)
        imgui.end_combo()
    hint(view, "camera")


def _sketch(view: DeskView, ask: Ask) -> None:
    """What the tracker sees, as dots: never the camera's picture."""
    place, width, height = (
        imgui.get_cursor_screen_pos(),
        imgui.get_content_region_avail().x,
        SKETCH_HEIGHT * scale(view),
    )
    pen = imgui.get_window_draw_list()
    pen.add_rect_filled(place, imgui.ImVec2(place.x + width, place.y + height), packed(theme.FIELD), 6 * scale(view))
    points = view.shot.sketch if view.shot is not None else None
    if points is None:
        words = "No face to sketch"
        size = imgui.calc_text_size(words)
        at = imgui.ImVec2(place.x + (width - size.x) / 2, place.y + (height - size.y) / 2)
        pen.add_text(at, packed(theme.FAINT), words)
    else:
        low, high = points.min(0), points.max(0)
        side = 0.84 * min(width / max(1e-3, high[0] - low[0]), height / max(1e-3, high[1] - low[1]))
        middle = (low + high) / 2
        across = -1.0 if view.state.mirror else 1.0
        ink, dot = packed(theme.ACCENT, 0.8), 0.9 * scale(view)
        for x, y in points[::2].tolist():
            at_x = place.x + width / 2 + across * (x - middle[0]) * side
            at_y = place.y + height / 2 + (y - middle[1]) * side
            pen.add_rect_filled(imgui.ImVec2(at_x, at_y), imgui.ImVec2(at_x + 2 * dot, at_y + 2 * dot), ink)
    if imgui.invisible_button("sketch", imgui.ImVec2(width, height)):
        ask("relock", None)
    hint(view, "relock")


def _transport(view: DeskView, ask: Ask) -> None:
    transport = view.transport
    assert transport is not None
    button(view, ask, "play", "Pause" if transport.playing else "Play", float(not transport.playing), columns(4))
    imgui.same_line()
    position, duration = transport.position, transport.duration
    known = duration < float("inf")  # of files that do not tell it, when their end was seen
    place = f"{position:.1f} of {duration:.1f} s" if known else f"{position:.1f} s"
    width = imgui.get_content_region_avail().x - imgui.calc_text_size(place).x - imgui.get_style().item_spacing.x
    changed, after = bar("##seek", position, 0.0, max(0.1, duration if known else position), width)
    hint(view, "seek")
    at_right(place)
    if changed:
        ask("seek", after)
    switch(view, ask, "loop", "Loop", view.state.loop)
