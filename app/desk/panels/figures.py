"""The foot of the window: how fast it goes, what draws, what was skipped."""

from imgui_bundle import imgui

from .. import theme
from ..view import DeskView
from .controls import Ask, at_right, colour


def figures(view: DeskView, ask: Ask) -> None:
    """One line: fps, milliseconds by stage, latency, drops, memory; provider and renderer at the right."""
    readings = view.readings
    parts = [f"{readings.fps:.0f} fps"]
    parts += [f"{stage} {1000 * seconds:.1f}" for stage, seconds in readings.stages.items()]
    if readings.latency:
        parts.append(f"latency {1000 * readings.latency:.0f} ms")
    parts.append(f"{readings.drops} skipped")
    if readings.megabytes:
        parts.append(f"{readings.megabytes:.0f} MB")
    imgui.push_style_color(imgui.Col_.text, colour(theme.TEXT))
    imgui.text_unformatted(parts[0])
    imgui.pop_style_color()
    imgui.push_style_color(imgui.Col_.text, colour(theme.FAINT))
    for part in parts[1:]:
        imgui.same_line(0, 16)
        imgui.text_unformatted(part)
    imgui.pop_style_color()
    where = ", ".join(part for part in (readings.provider, readings.engine) if part)
    imgui.same_line(0, 16)
    if where and imgui.calc_text_size(where).x < imgui.get_content_region_avail().x:
        at_right(where)
