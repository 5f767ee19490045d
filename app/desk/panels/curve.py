"""The compression plot: what fewer components cost in quality, and save in memory."""

import numpy as np
from imgui_bundle import imgui, implot

from .. import theme
from ..theme import Colour
from ..view import DeskView
from .controls import Ask, button, colour, faint, heading, packed, scale

WIDTH, HEIGHT = 460.0, 240.0
MAX_DB = 60.0
_FLAGS = implot.Flags_.no_inputs.value | implot.Flags_.no_menus.value


def _line(ink: Colour) -> implot.Spec:
    spec = implot.Spec()
    spec.line_color, spec.line_weight = colour(ink), 2.0
    return spec


def curve(view: DeskView, ask: Ask) -> None:
    """PSNR and MB over the components, with a line at the count in use."""
    heading("Compression of this avatar", "against all components")
    if view.curve is None:
        faint("Measuring; this takes a few seconds.")
        return
    measured, unit = view.curve, scale(view)
    counts = np.ascontiguousarray(measured.components, np.float64)
    decibels = np.ascontiguousarray(np.minimum(measured.decibels, MAX_DB))
    if implot.begin_plot("##curve", imgui.ImVec2(-1, HEIGHT * unit), _FLAGS):
        implot.setup_axes("components", "dB")
        implot.setup_legend(implot.Location_.south_east.value)
        implot.setup_axis(implot.ImAxis_.y2, "MB", implot.AxisFlags_.aux_default.value)
        implot.setup_axis_limits(implot.ImAxis_.x1, 0, float(counts[-1]) + 1)
        implot.setup_axis_limits(implot.ImAxis_.y1, float(decibels.min()) - 3, float(decibels.max()) + 3)
        implot.setup_axis_limits(implot.ImAxis_.y2, 0, float(measured.megabytes.max()) * 1.15)
        implot.plot_line("quality, dB", counts, decibels, _line(theme.ACCENT))
        implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y2)
        implot.plot_line("memory, MB", counts, measured.megabytes.copy(), _line(theme.FAINT))
        implot.set_axes(implot.ImAxis_.x1, implot.ImAxis_.y1)
        used = implot.plot_to_pixels(float(view.state.used_components), 0.0)
        place, size = implot.get_plot_pos(), implot.get_plot_size()
        implot.get_plot_draw_list().add_line(
            imgui.ImVec2(used.x, place.y), imgui.ImVec2(used.x, place.y + size.y), packed(theme.ACCENT, 0.8), 1.5 * unit
        )
        implot.end_plot()
    button(view, ask, "curve", "Close", 0.0)
