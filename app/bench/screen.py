"""What is really on the screen: pixels of a window as the X server has them, or of a framebuffer without a window."""

import ctypes
import ctypes.util
import sys
from collections.abc import Iterator
from typing import Any, Protocol

import moderngl
import numpy as np
from numpy.typing import NDArray

_ALL_PLANES, _Z_PIXMAP = ctypes.c_ulong(-1).value, 2


class Reader(Protocol):
    """Reads single pixels."""

    def row(self, columns: NDArray[np.int64], row: int) -> NDArray[np.uint8] | None:
        """[n] brightness of the pixels of one row, counted from the top left of the window; None when unreadable."""
        ...


class FramebufferReader:
    """The framebuffer that was drawn to last: what a screen would show."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context

    def row(self, columns: NDArray[np.int64], row: int) -> NDArray[np.uint8] | None:
        """Waits until the drawing is done."""
        target = self._context.fbo
        left, width = _span(columns)
        viewport = (left, target.height - 1 - row, width, 1)
        with self._context:
            data = np.frombuffer(target.read(viewport, components=3, alignment=1), np.uint8).reshape(-1, 3)
        return data[columns - left, 1].copy()


class XWindowReader:
    """A window of an X server, read over a connection of its own, as any other program would see it."""

    def __init__(self, title: str) -> None:
        """Raises OSError without an X server, or without a window of this title."""
        self._x = _xlib()
        self._display = self._x.XOpenDisplay(None)
        if not self._display:
            raise OSError("there is no X server")
        self._x.XSetErrorHandler(_IGNORE)  # a window that is gone must not end the program
        root = self._x.XDefaultRootWindow(self._display)
        self._window = next((window for window in self._tree(root) if self._title(window) == title), None)
        if self._window is None:
            raise OSError(f"there is no window called {title}")

    def row(self, columns: NDArray[np.int64], row: int) -> NDArray[np.uint8] | None:
        """None while the window cannot be seen."""
        left, width = _span(columns)
        image = self._x.XGetImage(self._display, self._window, left, row, width, 1, _ALL_PLANES, _Z_PIXMAP)
        if not image:
            return None
        pixels = [self._x.XGetPixel(image, int(column) - left, 0) for column in columns]
        self._x.XDestroyImage(image)
        return np.array([pixel >> 8 & 255 for pixel in pixels], np.uint8)

    def _tree(self, window: int) -> Iterator[int]:
        yield window
        root, parent, count = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_uint()
        children = ctypes.POINTER(ctypes.c_ulong)()
        found = (ctypes.byref(value) for value in (root, parent, children, count))
        if self._x.XQueryTree(self._display, window, *found) and count.value:
            inside = children[: count.value]
            self._x.XFree(children)
            for child in inside:
                yield from self._tree(child)

    def _title(self, window: int) -> str:
        name = ctypes.c_char_p()
        if not self._x.XFetchName(self._display, window, ctypes.byref(name)) or name.value is None:
            return ""
        title = name.value.decode("utf-8", "replace")
        self._x.XFree(name)
        return title


def _span(columns: NDArray[np.int64]) -> tuple[int, int]:
    """The first column, and how many there are to the last."""
    return int(columns.min()), int(columns.max() - columns.min()) + 1


def reader_of(context: moderngl.Context, title: str | None) -> Reader:
    """The best there is for the window of this ``title``; None: there is no window."""
    if title is not None and sys.platform.startswith("linux"):
        try:
            return XWindowReader(title)
        except OSError:
            pass  # Wayland: what was drawn has to do
    return FramebufferReader(context)


@ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
def _IGNORE(display: Any, event: Any) -> int:
    return 0


def _xlib() -> Any:
    name = ctypes.util.find_library("X11")
    if name is None:
        raise OSError("there is no X11 library")
    x = ctypes.CDLL(name)
    pointer, number = ctypes.c_void_p, ctypes.c_ulong
    x.XOpenDisplay.restype = pointer
    x.XDefaultRootWindow.argtypes, x.XDefaultRootWindow.restype = [pointer], number
    x.XQueryTree.argtypes = [pointer, number, *[pointer] * 4]
    x.XFetchName.argtypes = [pointer, number, pointer]
    x.XFree.argtypes = [pointer]
    x.XGetImage.argtypes = [
        pointer,
        number,
        ctypes.c_int,
        ctypes.c_int,
        ctypes.c_uint,
        ctypes.c_uint,
        number,
        ctypes.c_int,
    ]
    x.XGetImage.restype = pointer
    x.XGetPixel.argtypes, x.XGetPixel.restype = [pointer, ctypes.c_int, ctypes.c_int], number
    x.XDestroyImage.argtypes = [pointer]
    return x
