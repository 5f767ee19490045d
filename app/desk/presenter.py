"""From what was drawn to the screen: the whole window, or only the part of it that changed."""

import ctypes
import ctypes.util
import time
from collections.abc import Callable
from typing import Any

import glfw

from .canvas import Box

SOFTWARE = ("llvmpipe", "softpipe", "swrast")
"""How OpenGL without a GPU calls itself: there every pixel costs, and no screen is waited for anyway."""
EXTENSION = "GLX_MESA_copy_sub_buffer"
RESIZING_SECS = 0.5
"""So long after its size changed a window may be changing on: only when buffers are swapped they take its new size, and
what is copied to a window of another size is an error."""
_COPY = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_ulong, *[ctypes.c_int] * 4)
_ON_ERROR = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)


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
        if quick:
            _outlive_errors()
        self._size, self._resized_at = (0, 0), 0.0
        self.lost = self.keeps
        """Whether what ``keeps`` promises is broken for once, because buffers were swapped: all must be drawn again."""

    @property
    def keeps(self) -> bool:
        """Whether what was drawn is still there after ``present``."""
        return self._copy is not None

    def present(self, changed: Box | None, size: tuple[int, int]) -> None:
        """Show what was drawn; ``changed``: only this part of ``size`` pixels did, None for all."""
        now = time.perf_counter()
        if size != self._size:
            self._size, self._resized_at = size, now
        if self._copy is None or now - self._resized_at < RESIZING_SECS:
            glfw.swap_buffers(self._window)
            self.lost = self.keeps
        else:
            self._copy(*(changed or (0, 0, *size)))
            self.lost = False


@_ON_ERROR
def _go_on(display: int | None, event: int | None) -> int:
    """What Xlib does with an error unless told otherwise is to end the program, with nothing saved."""
    return 0


def _outlive_errors() -> None:
    """A window may have another size than was last heard of, however soon that is: then a picture is lost, no more."""
    library = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
    library.XSetErrorHandler.restype = ctypes.c_void_p
    library.XSetErrorHandler(_go_on)


def _copier(window: Any) -> Callable[[int, int, int, int], None]:
    """Copies a box to the front buffer; the box of the back buffer stays as it is."""
    copy = _COPY(ctypes.cast(glfw.get_proc_address("glXCopySubBufferMESA"), ctypes.c_void_p).value or 0)
    display, drawable = glfw.get_x11_display(), glfw.get_glx_window(window)
    return lambda *box: copy(display, drawable, *box)
