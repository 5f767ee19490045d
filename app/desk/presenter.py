"""From what was drawn to the screen: the whole window, or only the part of it that changed."""

import ctypes
from collections.abc import Callable
from typing import Any

import glfw

from .canvas import Box

SOFTWARE = ("llvmpipe", "softpipe", "swrast")
"""How OpenGL without a GPU calls itself: there every pixel costs, and no screen is waited for anyway."""
EXTENSION = "GLX_MESA_copy_sub_buffer"
_COPY = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_ulong, *[ctypes.c_int] * 4)


class Presenter:
    """Swaps a window's buffers.

    Where OpenGL is software it copies from one to the other instead, if GLX_MESA_copy_sub_buffer is there: after that,
    and only after that, what was drawn stays where it is, and the next frame need not draw it again.
    """

    def __init__(self, window: Any, renderer: str) -> None:
        """In the thread where the context of ``window`` is current; ``renderer``: GL_RENDERER."""
        self._window = window
        quick = any(name in renderer for name in SOFTWARE) and glfw.extension_supported(EXTENSION)
        self._copy = _copier(window) if quick else None
        self._size = (0, 0)
        self.lost = self.keeps
        """Whether what ``keeps`` promises is broken for once, because buffers were swapped: all must be drawn again."""

    @property
    def keeps(self) -> bool:
        """Whether what was drawn is still there after ``present``."""
        return self._copy is not None

    def present(self, changed: Box | None, size: tuple[int, int]) -> None:
        """Show what was drawn; ``changed``: only this part of ``size`` pixels did, None for all."""
        if self._copy is None or size != self._size:  # only when buffers are swapped they take the window's new size
            glfw.swap_buffers(self._window)
            self._size, self.lost = size, self.keeps
        else:
            self._copy(*(changed or (0, 0, *size)))
            self.lost = False


def _copier(window: Any) -> Callable[[int, int, int, int], None]:
    """Copies a box to the front buffer; the box of the back buffer stays as it is."""
    copy = _COPY(ctypes.cast(glfw.get_proc_address("glXCopySubBufferMESA"), ctypes.c_void_p).value or 0)
    display, drawable = glfw.get_x11_display(), glfw.get_glx_window(window)
    return lambda *box: copy(display, drawable, *box)
