"""How the window looks: one accent colour on neutral dark, one grid, one family of letters."""

from pathlib import Path

import imgui_bundle
from imgui_bundle import imgui, implot

Colour = tuple[float, float, float, float]

GROUND: Colour = (0.082, 0.087, 0.097, 1.0)
"""Behind everything."""
PANEL: Colour = (0.105, 0.112, 0.125, 1.0)
FIELD: Colour = (0.145, 0.153, 0.170, 1.0)
FIELD_HOVERED: Colour = (0.190, 0.200, 0.222, 1.0)
LINE: Colour = (1.0, 1.0, 1.0, 0.07)
TEXT: Colour = (0.925, 0.932, 0.945, 1.0)
FAINT: Colour = (0.595, 0.620, 0.665, 1.0)
ACCENT: Colour = (0.255, 0.760, 0.680, 1.0)
ACCENT_HOVERED: Colour = (0.330, 0.840, 0.755, 1.0)
ON_ACCENT: Colour = (0.035, 0.085, 0.078, 1.0)
WARNING: Colour = (0.955, 0.705, 0.300, 1.0)
ALARM: Colour = (0.945, 0.385, 0.365, 1.0)
FONT_PX = 15.0
UNIT = 8.0
"""Everything is a multiple of this at scale 1, in pixels."""


class Letters:
    """The fonts: one for text, one for what is read first."""

    def __init__(self) -> None:
        fonts = Path(imgui_bundle.__file__).parent / "assets" / "fonts" / "Roboto"
        atlas = imgui.get_io().fonts
        self.text = atlas.add_font_from_file_ttf(str(fonts / "Roboto-Regular.ttf"), FONT_PX)
        self.strong = atlas.add_font_from_file_ttf(str(fonts / "Roboto-Bold.ttf"), FONT_PX)


def dress(scale: float) -> None:
    """Give panels and plots their looks, ``scale`` times as large as at first."""
    style = imgui.get_style()
    pairs = {
        "window_padding": (2 * UNIT, 1.5 * UNIT),
        "frame_padding": (9, 3),
        "item_spacing": (UNIT, 5),
        "item_inner_spacing": (UNIT, UNIT / 2),
        "cell_padding": (UNIT / 2, UNIT / 4),
        "separator_text_padding": (0, UNIT / 2),
    }
    for name, (x, y) in pairs.items():
        setattr(style, name, imgui.ImVec2(x * scale, y * scale))
    lengths = {
        "window_rounding": 6,
        "child_rounding": 6,
        "popup_rounding": 6,
        "frame_rounding": 4,
        "grab_rounding": 4,
        "grab_min_size": 10,
        "scrollbar_size": 8,
        "scrollbar_rounding": 4,
        "indent_spacing": 2 * UNIT,
        "window_border_size": 0,
        "frame_border_size": 0,
        "child_border_size": 0,
        "popup_border_size": 1,
        "separator_text_border_size": 0,
    }
    for name, length in lengths.items():
        setattr(style, name, length * scale)
    style.disabled_alpha = 0.45
    style.font_size_base = FONT_PX
    style.font_scale_main = scale
    colours = {
        "text": TEXT,
        "text_disabled": FAINT,
        "window_bg": PANEL,
        "child_bg": (0, 0, 0, 0),
        "popup_bg": (*PANEL[:3], 0.98),
        "border": LINE,
        "separator": LINE,
        "frame_bg": FIELD,
        "frame_bg_hovered": FIELD_HOVERED,
        "frame_bg_active": FIELD_HOVERED,
        "title_bg": PANEL,
        "title_bg_active": PANEL,
        "menu_bar_bg": PANEL,
        "scrollbar_bg": (0, 0, 0, 0),
        "scrollbar_grab": FIELD_HOVERED,
        "scrollbar_grab_hovered": FAINT,
        "scrollbar_grab_active": FAINT,
        "check_mark": ON_ACCENT,
        "checkbox_selected_bg": ACCENT,
        "slider_grab": ACCENT,
        "slider_grab_active": ACCENT_HOVERED,
        "button": FIELD,
        "button_hovered": FIELD_HOVERED,
        "button_active": (*ACCENT[:3], 0.55),
        "header": (*ACCENT[:3], 0.22),
        "header_hovered": FIELD_HOVERED,
        "header_active": (*ACCENT[:3], 0.35),
        "plot_histogram": ACCENT,
        "plot_lines": ACCENT,
        "nav_cursor": ACCENT,
        "nav_windowing_highlight": ACCENT,
        "nav_windowing_dim_bg": (0, 0, 0, 0),
        "text_selected_bg": (*ACCENT[:3], 0.35),
        "table_border_light": LINE,
        "modal_window_dim_bg": (0, 0, 0, 0.45),
    }
    for name, colour in colours.items():
        style.set_color_(getattr(imgui.Col_, name), imgui.ImVec4(*colour))
    _dress_plots()


def _dress_plots() -> None:
    style = implot.get_style()
    for name, colour in {
        "frame_bg": (0, 0, 0, 0),
        "plot_bg": FIELD,
        "plot_border": (0, 0, 0, 0),
        "legend_bg": PANEL,
        "legend_border": (0, 0, 0, 0),
        "axis_grid": LINE,
        "axis_text": FAINT,
    }.items():
        style.set_color_(getattr(implot.Col_, name), imgui.ImVec4(*colour))
