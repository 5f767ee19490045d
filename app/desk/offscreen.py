"""The window without a display: the same picture and panels on EGL, keys and pointer put in by hand."""

import moderngl
import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from ...render.contexts import offscreen_context
from .actions import Order
from .keys import RESERVED, Keymap, keymap
from .screen import Screen, dropped
from .view import DeskView

FRAME_SECS = 1 / 60


class DeskOffscreen:
    """For tests, screenshots and machines without a display: the face of ``window.DeskWindow``."""

    def __init__(self, size: tuple[int, int] = (1280, 800)) -> None:
        """``size``: width and height in pixels. Raises NoOpenGLError."""
        self.context: moderngl.Context = offscreen_context()
        self.size = size
        self.keymap: Keymap = keymap()
        self.visible = True
        self._target = self.context.simple_framebuffer(size, 4)
        self.screen = Screen(self.context)
        self._orders: list[Order] = []
        self._writing = False
        self._released: imgui.Key | None = None
        self.clean_picture: NDArray[np.uint8] | None = None
        self.shown = 0
        """Pictures shown so far."""

    def poll(self, wait: float = 0.0) -> list[Order]:
        """What was asked for since the last call; ``wait`` is for windows."""
        orders, self._orders = self._orders, []
        return orders

    def wake(self) -> None:
        """For windows: nothing waits here."""

    def show(self, picture: NDArray[np.uint8] | None, view: DeskView) -> None:
        """Draw a frame; ``picture`` [H, W, 3|4] stays until another one comes."""
        inputs = imgui.get_io()
        inputs.display_size = imgui.ImVec2(*self.size)
        inputs.delta_time = FRAME_SECS
        self.keymap, self._writing = view.keymap, view.state.writing
        with self.context:  # whoever drew in it or read from it has let it go
            if picture is not None:
                self.screen.put(picture)
            self.screen.draw(view, self._target)
        if self._released is not None:
            inputs.add_key_event(self._released, False)
            self._released = None
        self._orders += self.screen.orders
        self.screen.orders.clear()
        self.shown += 1

    def clean(self, picture: NDArray[np.uint8] | None) -> bool:
        """What the clean window would show is kept in ``clean_picture``."""
        self.clean_picture = None if picture is None else picture.copy()
        return True

    def pixels(self) -> NDArray[np.uint8]:
        """[H, W, 3] what is on the screen, upright."""
        with self.context:
            raw = np.frombuffer(self._target.read(components=3), np.uint8)
        return raw.reshape(self.size[1], self.size[0], 3)[::-1].copy()

    def resize(self, size: tuple[int, int]) -> None:
        """Another size from now on."""
        with self.context:
            self.context.detect_framebuffer(0).use()  # one that stayed bound would be an error in the next call
            self._target.release()
            self.size, self._target = size, self.context.simple_framebuffer(size, 4)

    def press(self, key: str) -> None:
        """Type a key by its name, such as ``Ctrl+Q``."""
        typing = (self._writing or self.screen.typing) and key not in RESERVED
        order = None if typing else self.keymap.order(key)
        self._orders += [order] if order is not None else []

    def point(self, x: float, y: float, down: bool | None = None) -> None:
        """Move the pointer, and press or release its left button."""
        inputs = imgui.get_io()
        inputs.add_mouse_pos_event(x, y)
        if down is not None:
            inputs.add_mouse_button_event(0, down)

    def scroll(self, notches: float) -> None:
        """Turn the wheel."""
        imgui.get_io().add_mouse_wheel_event(0, notches)

    def type(self, words: str) -> None:
        """Type letters into the text field that has them."""
        for letter in words:
            imgui.get_io().add_input_character(ord(letter))

    def key(self, name: str) -> None:
        """Press and release a key for the panels, such as ``Enter`` or ``Down``."""
        arrows = {"Left": "left_arrow", "Right": "right_arrow", "Up": "up_arrow", "Down": "down_arrow"}
        pressed = getattr(imgui.Key, arrows.get(name, name.lower()))
        imgui.get_io().add_key_event(pressed, True)
        self._released = pressed

    def drop(self, *paths: str) -> None:
        """Drop files."""
        self._orders += dropped(list(paths))

    def close(self) -> None:
        """Release the context."""
        with self.context:
            self.screen.close()
            self._target.release()
        self.context.release()
