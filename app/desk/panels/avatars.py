"""The avatars there are, and how much of one is used."""

from imgui_bundle import imgui

from ...credentials.origin import NO_CONSENT, plain
from .. import theme
from ..view import DeskView
from .controls import Ask, at_right, button, columns, dial, faint, heading, hint, rule, switch, text

SHOWN = 9
"""Avatars that have a key."""


def avatars(view: DeskView, ask: Ask) -> None:
    """Left column: who is on stage."""
    heading("Avatars", "1-9")
    for index, name in enumerate(view.avatars):
        number = str(index + 1) if index < SHOWN else " "
        chosen = index == view.on_stage and not view.loading
        size = imgui.ImVec2(0, imgui.get_frame_height())
        imgui.push_style_var(imgui.StyleVar_.selectable_text_align, imgui.ImVec2(0, 0.5))
        pressed, _ = imgui.selectable(f"{number}   {_titled(name)}##{index}", chosen, 0, size)
        imgui.pop_style_var()
        if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip.value):
            imgui.set_tooltip(name)  # whole, where the column cuts it
        if pressed:
            ask("avatar", float(index + 1))
    if view.loading:
        faint(f"Loading {view.loading} ...")
    button(view, ask, "open", "Open a file ...", width=-1)


def components(view: DeskView, ask: Ask) -> None:
    """Left column: how many components are shown, and what that costs and loses."""
    state, curve = view.state, view.curve
    rule(view)
    heading("Components", f"{state.used_components} of {state.limits.components}")
    imgui.set_next_item_width(-1)
    changed, after = imgui.slider_int(
        "##components", state.used_components, 1, state.limits.components, "%d", imgui.SliderFlags_.always_clamp.value
    )
    hint(view, "components")
    if changed:
        ask("components", float(after))
    decibels = curve.decibels_at(state.used_components) if curve is not None else float("nan")
    whole = state.used_components == state.limits.components
    error = "exact" if whole else (f"{decibels:.1f} dB" if decibels == decibels else "... dB")
    if view.readings.lowered:
        error = "lowered"  # what is drawn is less than what was chosen
    faint(f"{view.avatar.megabytes:.1f} MB")
    at_right(error)
    imgui.same_line()
    middle = f"{view.readings.fps:.0f} fps"
    width = imgui.get_window_width()
    imgui.set_cursor_pos_x((width - imgui.calc_text_size(middle).x) / 2)
    faint(middle)
    if view.readings.lowered:
        text(view.readings.lowered, theme.WARNING)
        hint(view, "ladder")


def modalities(view: DeskView, ask: Ask) -> None:
    """Left column: which modalities move, and the tools that look into them."""
    state = view.state
    rule(view)
    heading("What moves")
    if imgui.begin_table("modalities", 2):
        for name in ("position", "rotation", "scale", "opacity"):
            imgui.table_next_column()
            switch(view, ask, name, name.capitalize(), name not in state.off)
        imgui.end_table()
    rule(view)
    heading("Inspect")
    width = columns(3)
    button(view, ask, "compare", "A/B", width=width, lit=state.compare)
    imgui.same_line()
    button(view, ask, "curve", "Curve", width=width, lit=state.curve)
    imgui.same_line()
    button(view, ask, "explore", "Explore", width=width, lit=state.exploring.on)


def comparison(view: DeskView, ask: Ask) -> None:
    """Left column, while A and B are compared: where they differ and by how much."""
    if view.state.compare:
        switch(view, ask, "error_map", "Error map", view.state.error_map)
        if view.error_db is not None:
            at_right("identical" if view.error_db > 99 else f"{view.error_db:.1f} dB")
        dial(view, ask, "split", "Split", view.state.split, 0, 1, "%.2f")


def licence(view: DeskView, ask: Ask) -> None:
    """Left column, at its foot: whose face this is."""
    rule(view)
    about = view.avatar.about
    heading(_titled(view.avatar.name) or "No avatar", f"{view.avatar.splats:,} splats" if view.avatar.splats else "")
    for name in ("licence", "consent", "author"):
        if words := plain(about.get(name, "")).strip():
            faint(f"{name.capitalize()}: {words}")
        elif name == "consent" and view.avatar.name:
            text(f"{NO_CONSENT.capitalize()}.", theme.WARNING)


def _titled(name: str) -> str:
    """Its first letter in capitals; what else is in capitals was meant so."""
    return name[:1].upper() + name[1:]
