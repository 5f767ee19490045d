"""A second window with nothing but the picture in it."""

from collections.abc import Callable
from typing import Any

import glfw
import numpy as np
from numpy.typing import NDArray

from ...render.contexts import window_context
from ..senders.fitting import fitted
from ..senders.virtualcamera import CHROMA_GREEN
from .picture import Area, PictureOnScreen

TITLE = "gemheads clean"


class CleanWindow:
    """A second window with nothing but the picture, to be captured by other programs."""

    def __init__(self, size: tuple[int, int], listen: Callable[[Any], None]) -> None:
        """Opens beside the first window, which keeps keyboard and context.

        ``listen`` is given the new window's handle to hear its keys. Raises NoOpenGLError.
        """
        before = glfw.get_current_context()
        for hint in (glfw.FOCUSED, glfw.FOCUS_ON_SHOW):
            glfw.window_hint(hint, glfw.FALSE)
        self._window, self._context = window_context(*size, TITLE)
        listen(self._window)
        glfw.swap_interval(0)
        self._picture = PictureOnScreen(self._context)
        glfw.make_context_current(before)

    @property
    def wanted(self) -> bool:
        """False once its close button was pressed."""
        return not glfw.window_should_close(self._window)

    def show(self, picture: NDArray[np.uint8]) -> None:
        """The picture [H, W, 3|4], as large as it fits on black; what is transparent is green, as in the virtual
        camera, so that who captures it can take it away."""
        before, size = glfw.get_current_context(), glfw.get_framebuffer_size(self._window)
        if min(size) < 1:
            return
        glfw.make_context_current(self._window)
        self._context.screen.use()
        self._context.viewport = (0, 0, *size)
        self._context.clear(0, 0, 0, 1)
        if picture.shape[2] == 4:
            picture = fitted(picture, (picture.shape[1], picture.shape[0]), CHROMA_GREEN)
        self._picture.put(picture)
        area = Area(0, 0, *size).fitted(picture.shape[1], picture.shape[0])
        self._picture.draw(area, size, mirrored=False)
        glfw.swap_buffers(self._window)
        glfw.make_context_current(before)

    def close(self) -> None:
        """Close it."""
        glfw.destroy_window(self._window)
