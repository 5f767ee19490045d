"""The stage: camera, ground and light; and where the picture goes besides the window."""

from imgui_bundle import imgui

from .. import theme
from ..state import BACKGROUNDS, EXPOSURES, ZOOMS
from ..view import DeskView
from .controls import Ask, button, columns, dial, faint, heading, hint, rule, switch, text

LIMIT_HINT = "The avatar was not made to be seen from further round."


def stage(view: DeskView, ask: Ask) -> None:
    """Left column: how the avatar is looked at."""
    state = view.state
    rule(view)
    heading("Stage")
    dial(view, ask, "yaw", "Round", state.yaw, -state.limits.yaw_deg, state.limits.yaw_deg, "%.0f°")
    dial(view, ask, "pitch", "Height", state.pitch, -state.limits.pitch_deg, state.limits.pitch_deg, "%.0f°")
    dial(view, ask, "zoom", "Zoom", state.zoom, *ZOOMS, "x %.2f")
    if state.at_limit:
        text(LIMIT_HINT, theme.WARNING)
    dial(view, ask, "exposure", "Light", state.exposure, *EXPOSURES, "%+.1f EV")
    dial(view, ask, "warmth", "Warmth", state.warmth, -1, 1, "%+.2f")
    imgui.set_next_item_width(-1)
    if imgui.begin_combo("##background", f"Ground: {state.background}"):
        for name in BACKGROUNDS:
            if imgui.selectable(name.capitalize(), name == state.background)[0]:
                ask("background", name)
        imgui.end_combo()
    hint(view, "background")
    switch(view, ask, "mirror", "Mirror here", state.mirror)


def outputs(view: DeskView, ask: Ask) -> None:
    """Right column: what is written and sent. None of it has ever had a panel on it."""
    state = view.state
    rule(view)
    heading("Outputs")
    width = columns(2)
    button(view, ask, "record", "Stop recording" if state.record else "Record", width=width, lit=state.record)
    imgui.same_line()
    button(view, ask, "picture", "Picture", width=width)
    button(view, ask, "virtual_camera", "Virtual camera", width=width, lit=state.virtual_camera)
    imgui.same_line()
    button(view, ask, "clean_window", "Clean window", width=width, lit=state.clean_window)
    button(view, ask, "coefficients", "OSC out", width=width, lit=state.coefficients)
    imgui.same_line()
    button(view, ask, "curtain", "Curtain", width=width, lit=state.curtain)
    switch(view, ask, "microphone", "Record sound too", state.microphone)
    switch(view, ask, "badge", "SYNTHETIC badge", not state.no_badge)
    if state.virtual_camera:
        switch(view, ask, "camera_badge", "Badge in the camera too", state.camera_badge)
    if state.no_badge:
        faint(f"No badge: {state.no_badge}")
    for line in view.outputs:
        words = f"{line.name}: {line.status}" + (f", {line.drops} skipped" if line.drops else "")
        text(words, theme.ALARM if line.failed else theme.FAINT)
