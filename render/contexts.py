"""OpenGL contexts: without a window, or a window's own."""

import sys
import warnings
from typing import Any

import moderngl

_CURE = "install OpenGL (Debian, Ubuntu: apt-get install libegl1 libgl1 libgl1-mesa-dri) or a graphics driver"
_VERSION = 330


class NoOpenGLError(RuntimeError):
    """OpenGL 3.3 core could not be had here."""


def offscreen_context() -> moderngl.Context:
    """A context that needs no display where EGL exists; current in this thread.

    Raises:
        NoOpenGLError: where no OpenGL 3.3 is installed.
    """
    backends: list[dict[str, Any]] = [{"backend": "egl"}] if sys.platform.startswith("linux") else []
    reasons = []
    for settings in (*backends, {}):
        try:
            return moderngl.create_context(standalone=True, require=_VERSION, **settings)
        except Exception as error:  # moderngl and its loaders raise whatever the platform gave them
            reasons.append(str(error))
    raise NoOpenGLError(f"no OpenGL 3.3 without a window ({'; '.join(reasons)}); {_CURE}")


def window_context(width: int, height: int, title: str, visible: bool = True) -> tuple[Any, moderngl.Context]:
    """A glfw window (its handle), ``width`` x ``height`` screen units, and its context, current in this thread.

    The caller destroys the window and terminates glfw.

    Raises:
        NoOpenGLError: where there is no display or no OpenGL 3.3.
    """
    import glfw  # the library looks for a display when it is loaded

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what glfw warns of is raised here in our own words
        return _opened(glfw, width, height, title, visible)


def _opened(glfw: Any, width: int, height: int, title: str, visible: bool) -> tuple[Any, moderngl.Context]:
    if not glfw.init():
        raise NoOpenGLError("glfw finds no display to open a window on; draw into a file, or log into a desktop")
    hints = (
        (glfw.CONTEXT_VERSION_MAJOR, 3),
        (glfw.CONTEXT_VERSION_MINOR, 3),
        (glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE),
        (glfw.OPENGL_FORWARD_COMPAT, True),  # macOS gives 3.3 only so
        (glfw.VISIBLE, visible),
    )
    for hint, value in hints:
        glfw.window_hint(hint, value)
    window = glfw.create_window(width, height, title, None, None)
    if not window:
        if not glfw.get_current_context():  # another window may be open
            glfw.terminate()
        raise NoOpenGLError(f"no window with OpenGL 3.3 could be opened; {_CURE}")
    glfw.make_context_current(window)
    return window, moderngl.create_context(require=_VERSION)
