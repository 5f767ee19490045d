"""One frame of the window: the picture and the panels over it, into whatever framebuffer."""

import time
from collections.abc import Callable
from pathlib import Path

import moderngl
import numpy as np
from imgui_bundle import imgui, implot
from numpy.typing import NDArray

from . import theme
from .actions import Order
from .canvas import Box, Canvas, box_of
from .layout import Layout, Panels, covers, laid_out
from .picture import Area, PictureOnScreen
from .state import DeskState
from .view import DeskView

GRIP_PX = 12.0
"""How near to the split's line the pointer takes it."""
DEGREES_PER_PX = 0.3
ZOOM_PER_NOTCH = 0.1
PANELS_EVERY = 1 / 6
"""Seconds between two drawings of panels that nobody touches."""


class Screen:
    """The picture and the panels of one GL context. What panels and pointer ask for is collected in ``orders``."""

    def __init__(self, context: moderngl.Context, kept: bool = False) -> None:
        """In the thread where ``context`` is current; it may only be used there.

        ``kept``: targets hold what was drawn into them last; where they do not, panels are kept beside them.
        """
        self.kept = kept
        self._context = context
        self._picture = PictureOnScreen(context)
        self._gui = imgui.create_context()
        self._plots = implot.create_context()
        inputs = imgui.get_io()
        inputs.set_ini_filename("")  # nothing is written where the program happens to be started
        self._letters = theme.Letters()
        imgui.backends.opengl3_init("#version 330")
        self.panels = Panels()
        """What draws them."""
        self._scale = 0.0
        self._size: tuple[int, int] | None = None
        self._held = ""
        self._canvas = Canvas(context)
        self._state: DeskState | None = None
        self._shown: Area | None = None
        self._covered = self._cramped = False
        self._panels_at = float("-inf")
        self.orders: list[Order] = []

    @property
    def typing(self) -> bool:
        """Whether letters belong to a text field."""
        return imgui.get_io().want_text_input

    def put(self, picture: NDArray[np.uint8]) -> None:
        """Show another picture [H, W, 3|4] from now on."""
        self._picture.put(picture)
        self._size = (picture.shape[1], picture.shape[0])

    def draw(
        self,
        view: DeskView,
        target: moderngl.Framebuffer,
        begin: Callable[[], None] | None = None,
        touched: bool = True,
        density: float = 1.0,
        size: tuple[int, int] | None = None,
    ) -> Box | None:
        """Draw a frame into ``target``, and give the pixels of it that changed, as far as is known; None for all.

        Args:
            view: what panels show.
            target: all of it is drawn.
            begin: tells imgui of pointer and keys.
            touched: whether pointer or keys moved since the last frame. While they did not and nothing lies over the
                picture, panels are drawn six times a second, the picture each time.
            density: pixels of ``target`` for each unit of the screen, in which panels and pointer are placed.
            size: width and height of ``target`` in pixels; None: as it says itself, which a window's does not know.
        """
        size, now = size or target.size, time.perf_counter()
        touched = self._canvas.fit(size) or touched
        layout = laid_out(view, size[0] / density, size[1] / density)
        self._tell_of_room(view.state.panels and layout.left is None)
        shown = layout.picture.fitted(*self._size) if self._size is not None else None
        alike = view.state == self._state and shown == self._shown
        over = covers(view, layout)
        fresh = not alike or touched or self._covered or now - self._panels_at >= PANELS_EVERY or over
        if fresh:
            self._state, self._shown, self._panels_at = view.state, shown, now
            if self.kept:
                target.use()
            else:
                self._canvas.use()
            self._draw_panels(view, layout, shown, size, begin, density)
        place = shown.scaled(density) if shown is not None and not (self._covered or over) else None
        if self.kept:
            target.use()
        else:
            self._canvas.copy(target, around=place)
        if place is not None:
            self._picture.draw(place, size, view.state.mirror)
        return box_of(place, *size) if place is not None and self.kept and not fresh else None

    def _draw_panels(
        self,
        view: DeskView,
        layout: Layout,
        shown: Area | None,
        size: tuple[int, int],
        begin: Callable[[], None] | None,
        density: float,
    ) -> None:
        """The panels, and below them the picture where they lie over it."""
        if view.state.ui_scale != self._scale:
            self._scale = view.state.ui_scale
            theme.dress(self._scale)
        self._walk(view.state.walking)
        imgui.backends.opengl3_new_frame()
        if begin is not None:
            begin()
        imgui.new_frame()
        self.panels.draw(view, self._ask, layout, shown)
        self._point(view, layout.picture, shown)
        any_popup = imgui.PopupFlags_.any_popup.value
        self._covered = imgui.is_any_item_hovered() or imgui.is_any_item_active() or imgui.is_popup_open("", any_popup)
        imgui.render()
        self._context.viewport = (0, 0, *size)
        self._context.clear(*theme.GROUND)
        if shown is not None and (self._covered or covers(view, layout)):
            self._picture.draw(shown.scaled(density), size, view.state.mirror)
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())

    def close(self) -> None:
        """Release what it holds."""
        self._picture.close()
        self._canvas.close()
        imgui.backends.opengl3_shutdown()
        implot.destroy_context(self._plots)
        imgui.destroy_context(self._gui)

    def _tell_of_room(self, cramped: bool) -> None:
        """Say once that panels that are wanted have no room."""
        if cramped and not self._cramped:
            self.orders.append(Order("no_room"))
        self._cramped = cramped

    def _ask(self, name: str, value: float | str | None) -> None:
        self.orders.append(Order(name, value))

    def _walk(self, on: bool) -> None:
        inputs, flag = imgui.get_io(), imgui.ConfigFlags_.nav_enable_keyboard.value
        inputs.config_flags = inputs.config_flags | flag if on else inputs.config_flags & ~flag

    def _point(self, view: DeskView, area: Area, shown: Area | None) -> None:
        """What the pointer does on the picture: turns the camera, zooms, moves the split."""
        inputs, state = imgui.get_io(), view.state
        if not inputs.mouse_down[0]:
            self._held = ""
        if (inputs.want_capture_mouse and not self._held) or state.writing or state.help:
            return
        x, y = inputs.mouse_pos.x, inputs.mouse_pos.y
        if imgui.is_mouse_clicked(0) and area.holds(x, y):
            line = None if shown is None else shown.left + shown.width * state.split
            near = state.compare and line is not None and abs(x - line) < GRIP_PX * self._scale
            self._held = "split" if near else "orbit"
            if not near:
                return  # what the pointer moved until now was before the button went down
        if self._held == "split" and shown is not None:
            self.orders.append(Order("split", (x - shown.left) / shown.width))
        elif self._held == "orbit" and (inputs.mouse_delta.x or inputs.mouse_delta.y):
            # the head turns with the hand; in a mirror the other way round
            across = 1.0 if state.mirror else -1.0
            self.orders.append(Order("yaw", across * DEGREES_PER_PX * inputs.mouse_delta.x, relative=True))
            self.orders.append(Order("pitch", DEGREES_PER_PX * inputs.mouse_delta.y, relative=True))
        if inputs.mouse_wheel and area.holds(x, y):
            self.orders.append(Order("zoom", ZOOM_PER_NOTCH * inputs.mouse_wheel, relative=True))


def dropped(paths: list[str]) -> list[Order]:
    """What dropping files asks for: the first one is opened."""
    return [Order("open", str(Path(paths[0])))] if paths else []
