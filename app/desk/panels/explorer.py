"""The explorer: what each component does, by sliders in sigma and sweeps."""

from imgui_bundle import imgui

from ....models.gem import CLAMP_SIGMAS, MODALITIES
from ..view import DeskView
from .controls import Ask, at_right, bar, button, columns, faint, heading, hint, rule, scale, switch

SLIDERS = 8
"""Components shown at once."""


def explorer(view: DeskView, ask: Ask) -> None:
    """Left column, while exploring: in place of the modalities."""
    exploring = view.state.exploring
    rule(view)
    heading("Explore", "sigma, added")
    width = columns(len(MODALITIES))
    for name in MODALITIES:
        button(view, ask, "explored_modality", name[:3].capitalize(), name, width, lit=name == exploring.modality)
        imgui.same_line()
    imgui.new_line()
    stored = view.avatar.mode_counts.get(exploring.modality, 0)
    first = max(0, min(exploring.component - SLIDERS // 2, stored - SLIDERS))
    for component in range(first, min(stored, first + SLIDERS)):
        _slider(view, ask, component)
    faint(f"{stored} stored, Shift+Up and Down" if stored else f"No {exploring.modality} components are stored")
    if stored:
        switch(view, ask, "sweep", "Sweep", exploring.sweep)
        imgui.same_line()
    button(view, ask, "unexplore", "All to rest", width=-1)
    button(view, ask, "explore", "Done", 0.0, width=-1)


def _slider(view: DeskView, ask: Ask, component: int) -> None:
    exploring = view.state.exploring
    size = imgui.ImVec2(24 * scale(view), 0)
    if imgui.selectable(f"{component + 1:2}##{component}", component == exploring.component, 0, size)[0]:
        ask("explored_component", float(component))
    imgui.same_line()
    swept = exploring.sweep and component == exploring.component
    value = view.swept if swept else exploring.value(exploring.modality, component)
    width = imgui.get_content_region_avail().x - 52 * scale(view)
    changed, after = bar(f"##sigma{component}", value, -CLAMP_SIGMAS, CLAMP_SIGMAS, width)
    hint(view, "sigma")
    at_right(f"{value:+.2f}")
    if changed:
        ask("explored_component", float(component))
        ask("sigma", after)
