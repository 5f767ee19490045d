"""The window on the screen: glfw's events become orders, a picture and the panels become a frame."""

import ctypes
import warnings
from typing import Any

from imgui_bundle import imgui  # isort: skip (first: it tells glfw which library both use)
import glfw  # isort: skip
import numpy as np
from numpy.typing import NDArray

from ...render.contexts import NoOpenGLError, window_context
from .actions import Order
from .cleanwindow import CleanWindow
from .keys import RESERVED, Keymap, keymap
from .presenter import Presenter
from .screen import Screen, dropped
from .view import DeskView

TITLE = "gemheads"
FIRST = (1280, 800)
"""Width and height of the first run's window, in screen units of a desktop that draws as large as usual."""
SMALLEST = (360, 300)
NAMES = {
    glfw.KEY_ESCAPE: "Esc",
    glfw.KEY_TAB: "Tab",
    glfw.KEY_SPACE: "Space",
    glfw.KEY_ENTER: "Enter",
    glfw.KEY_BACKSPACE: "Backspace",
    glfw.KEY_DELETE: "Delete",
    glfw.KEY_INSERT: "Insert",
    glfw.KEY_HOME: "Home",
    glfw.KEY_END: "End",
    glfw.KEY_PAGE_UP: "PageUp",
    glfw.KEY_PAGE_DOWN: "PageDown",
    glfw.KEY_LEFT: "Left",
    glfw.KEY_RIGHT: "Right",
    glfw.KEY_UP: "Up",
    glfw.KEY_DOWN: "Down",
    glfw.KEY_KP_ADD: "+",
    glfw.KEY_KP_SUBTRACT: "-",
    **{glfw.KEY_F1 + n: f"F{n + 1}" for n in range(24)},
}
WALKING = frozenset(("Space", "Enter", "Tab", "Left", "Right", "Up", "Down", "Home", "End", "PageUp", "PageDown"))
"""Keys that move about in the panels while they are walked."""


class DeskWindow:
    """A glfw window. Everything happens in the thread that made it."""

    def __init__(self, size: tuple[int, int] | None = None) -> None:
        """``size``: width and height in screen units, FIRST unless given. Raises contexts.NoOpenGLError where no window
        opens."""
        self._window, self.context = window_context(*within_screen(size or FIRST), TITLE)
        self.keymap: Keymap = keymap()
        self._orders: list[Order] = []
        self._walking = self._writing = False
        self._modifiers = 0
        self._repeated = False
        self._touched = self._open = True
        self._clean: CleanWindow | None = None
        self._placed: tuple[int, int, int, int] | None = None
        glfw.set_window_size_limits(self._window, *SMALLEST, glfw.DONT_CARE, glfw.DONT_CARE)
        glfw.swap_interval(1)
        self._listen(self._window)
        glfw.set_drop_callback(self._window, self.on_drop)  # pyright: ignore[reportArgumentType] (glfw makes a list)
        glfw.set_window_close_callback(self._window, self._on_close)
        for listen in (glfw.set_cursor_pos_callback, glfw.set_mouse_button_callback, glfw.set_scroll_callback):
            listen(self._window, self._on_touch)
        glfw.set_window_refresh_callback(self._window, self._on_touch)
        # kept, not asked for in every frame: the answer would come from another program, the X server
        self._size, self._pixels = glfw.get_window_size(self._window), glfw.get_framebuffer_size(self._window)
        self._minimised = bool(glfw.get_window_attrib(self._window, glfw.ICONIFIED))
        glfw.set_window_size_callback(self._window, self._on_size)
        glfw.set_framebuffer_size_callback(self._window, self._on_pixels)
        glfw.set_window_iconify_callback(self._window, self._on_minimise)
        self._presenter = Presenter(self._window, self.context.info["GL_RENDERER"])
        self.screen = Screen(self.context, self._presenter.keeps)
        # imgui calls the callbacks that are there already: it comes last
        imgui.backends.glfw_init_for_opengl(ctypes.cast(self._window, ctypes.c_void_p).value or 0, True)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in screen units."""
        return self._size

    @property
    def content_scale(self) -> float:
        """How much larger than usual the person's desktop draws; 1 where screen units take care of that."""
        return glfw.get_window_content_scale(self._window)[0] * self.size[0] / max(1, self._pixels[0])

    def grow(self, factor: float) -> None:
        """Be so many times as large, as far as the screen goes."""
        width, height = within_screen((round(factor * self._size[0]), round(factor * self._size[1])))
        glfw.set_window_size(self._window, max(self._size[0], width), max(self._size[1], height))

    @property
    def visible(self) -> bool:
        """Whether anybody can see it: not while minimised."""
        return not self._minimised and min(self._pixels) > 0

    def poll(self, wait: float = 0.0) -> list[Order]:
        """What was asked for since the last call, by keys, pointer, panels or dropped files.

        Args:
            wait: seconds to wait for an event when there is none.
        """
        if wait > 0 and not self._orders:
            glfw.wait_events_timeout(wait)
        else:
            glfw.poll_events()
        orders, self._orders = self._orders, []
        return orders

    def wake(self) -> None:
        """End the wait in ``poll``, or the next one; from any thread, at any time."""
        if self._open:
            glfw.post_empty_event()

    def show(self, picture: NDArray[np.uint8] | None, view: DeskView) -> None:
        """Draw a frame and swap; ``picture`` [H, W, 3|4] stays until another one comes. Nothing while minimised."""
        self.keymap, self._walking, self._writing = view.keymap, view.state.walking, view.state.writing
        glfw.make_context_current(self._window)  # an engine that drew in it has let it go
        if picture is not None:
            self.screen.put(picture)
        if not self.visible:
            return
        if view.state.full_screen != (glfw.get_window_monitor(self._window) is not None):
            self._fill(view.state.full_screen)
        touched = self._touched or bool(self._orders) or self._presenter.lost
        begin, density = imgui.backends.glfw_new_frame, self._pixels[0] / max(1, self.size[0])
        # moderngl believes a window's framebuffer to have for ever the size it was first seen with
        changed = self.screen.draw(view, self.context.screen, begin, touched, density, self._pixels)
        self._touched = False
        self._orders += self.screen.orders
        self.screen.orders.clear()
        self._presenter.present(changed, self._pixels)

    def clean(self, picture: NDArray[np.uint8] | None) -> bool:
        """Show the picture in the clean window too; None closes that. False when the person closed it."""
        if picture is None or (self._clean is not None and not self._clean.wanted):
            if self._clean is not None:
                self._clean.close()
            self._clean = None
            return picture is None
        if self._clean is None:
            try:
                self._clean = CleanWindow((picture.shape[1], picture.shape[0]), self._listen)
            except NoOpenGLError:
                return False
        self._clean.show(picture)
        return True

    def on_drop(self, window: Any, paths: list[str]) -> None:
        """Files were dropped on the window."""
        self._orders += dropped(paths)

    def quit(self) -> None:
        """Ask to quit, as its close button does."""
        self._orders.append(Order("quit"))

    def hide(self) -> None:
        """Take it off the screen."""
        glfw.hide_window(self._window)

    def close(self) -> None:
        """Close the window."""
        self._open = False
        self.clean(None)
        imgui.backends.glfw_shutdown()
        self.screen.close()
        glfw.destroy_window(self._window)
        glfw.terminate()

    def _on_touch(self, *_: Any) -> None:
        self._touched = True

    def _fill(self, whole: bool) -> None:
        """Fill the screen, or go back to where the window was."""
        if whole:
            self._placed = (*glfw.get_window_pos(self._window), *glfw.get_window_size(self._window))
            monitor = glfw.get_primary_monitor()
            mode = glfw.get_video_mode(monitor)
            glfw.set_window_monitor(self._window, monitor, 0, 0, *mode.size, mode.refresh_rate)
        elif self._placed is not None:
            nowhere: Any = None
            glfw.set_window_monitor(self._window, nowhere, *self._placed, glfw.DONT_CARE)

    def _listen(self, window: Any) -> None:
        """Hear the keys of a window."""
        glfw.set_key_callback(window, self._on_key)
        glfw.set_char_callback(window, self._on_character)

    def _on_size(self, window: Any, width: int, height: int) -> None:
        self._size, self._touched = (width, height), True

    def _on_pixels(self, window: Any, width: int, height: int) -> None:
        self._pixels, self._touched = (width, height), True

    def _on_minimise(self, window: Any, minimised: int) -> None:
        self._minimised = bool(minimised)

    def _on_close(self, window: Any) -> None:
        self.quit()

    def _on_key(self, window: Any, key: int, scancode: int, action: int, modifiers: int) -> None:
        """Keys that type no character, and those held with Ctrl or Alt; the others arrive in ``_on_character``."""
        self._touched = True
        if action == glfw.RELEASE:
            return
        self._modifiers, self._repeated = modifiers, action == glfw.REPEAT
        name = NAMES.get(key)
        if modifiers & (glfw.MOD_CONTROL | glfw.MOD_ALT) and (name is None or name in "+-"):
            name = name or _letter(key, scancode)
            if name == "=" and modifiers & glfw.MOD_SHIFT:  # + on keyboards such as the American one
                name, modifiers = "+", modifiers & ~glfw.MOD_SHIFT
        elif name in ("+", "-"):
            return
        if name is not None:
            self._press(name, modifiers)

    def _on_character(self, window: Any, codepoint: int) -> None:
        letter = chr(codepoint).upper()
        if letter.isspace() or self._modifiers & (glfw.MOD_CONTROL | glfw.MOD_ALT):
            return
        # Shift is part of what a punctuation mark is, on whatever layout, and apart from what a letter is
        self._press(letter, self._modifiers if letter.isalpha() else 0)

    def _press(self, name: str, modifiers: int) -> None:
        held = {"Ctrl": glfw.MOD_CONTROL, "Shift": glfw.MOD_SHIFT, "Alt": glfw.MOD_ALT}
        key = "+".join([*(word for word, bit in held.items() if modifiers & bit), name])
        typing = self._writing or self.screen.typing
        if typing and (key not in RESERVED or (key == "Esc" and not self._writing)):
            return  # Esc belongs to a number that is being typed, too
        if self._walking and key in WALKING:
            return
        order = self.keymap.order(key, self._repeated)
        if order is not None:
            self._orders.append(order)


def within_screen(size: tuple[int, int]) -> tuple[int, int]:
    """As much of a width and height in screen units as the screen has room for; all of it where there is no screen."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # whoever opens a window there says what is wrong
        monitor = glfw.get_primary_monitor() if glfw.init() else None
    if not monitor:
        return size
    _, _, width, height = glfw.get_monitor_workarea(monitor)
    return min(size[0], width), min(size[1], height)


def _letter(key: int, scancode: int) -> str | None:
    """What a key types on this keyboard's layout, in capitals."""
    name = glfw.get_key_name(key, scancode)
    return name.upper() if name and len(name) == 1 else None
