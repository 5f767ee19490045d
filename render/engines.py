"""One face for whatever draws, and the choice between them."""

import contextlib
import threading
import time
from statistics import median
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .enginename import EngineName
from .gaussians import RawGaussians
from .software import SoftwareEngine

if TYPE_CHECKING:
    import moderngl

_TRIALS = 3
"""Frames drawn by each engine before the faster one is chosen."""


class Engine(Protocol):
    """Draws splats, one frame at a time, in the thread that made it or, while not ``bound``, in any."""

    @property
    def name(self) -> str:
        """``quads`` or ``software``: what drew the last frame."""
        ...

    @property
    def description(self) -> str:
        """For people: the GL renderer, or the threads."""
        ...

    @property
    def timings(self) -> dict[str, float]:
        """Stage -> seconds of the last frame."""
        ...

    @property
    def bound(self) -> bool:
        """Whether the next frame can only be drawn in the thread that made the engine, as an OpenGL context wants."""
        ...

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]:
        """The picture [H, W, 4], premultiplied sRGB-encoded RGBA in [0, 1]; the engine's own, until the next frame."""
        ...

    def close(self) -> None:
        """Give back what it holds; no frame can be drawn afterwards."""
        ...


def open_engine(name: EngineName = "auto", context: "moderngl.Context | None" = None) -> Engine:
    """An engine that draws without a window, or in a window's own context.

    Args:
        name: ``quads`` is OpenGL, ``software`` numba, ``auto`` the faster of the two on this machine; where there is
            no OpenGL that is the software engine.
        context: a window's, current in this thread: quads then draw in it, into a framebuffer of their own, and leave
            it open when they close. None opens one that needs no window.

    Raises:
        ValueError: for another name.
        contexts.NoOpenGLError: when ``quads`` is asked for and there is no OpenGL 3.3.
    """
    if name == "software":
        return SoftwareEngine()
    if name not in ("auto", "quads"):
        raise ValueError(f"no engine is called '{name}'; there are auto, quads and software")
    # modules of OpenGL stay unloaded where they are not needed
    from .contexts import offscreen_context
    from .splats import SplatRenderer

    try:
        quads = SplatRenderer(context or offscreen_context(), owns_context=context is None)
    except Exception as error:  # no OpenGL, or a driver that cannot compile: it raises what it likes
        if name == "quads":
            raise
        return SoftwareEngine(str(error))
    return quads if name == "quads" else FastestEngine(quads, SoftwareEngine())


class FastestEngine:
    """Quads at once; when the software engine's kernels are ready, a few frames of each decide which one stays.

    The decision is kept for the process. An engine that raises is closed and the other one takes over for good; in
    another thread than the engine's own it only raises, and the next frame in that thread sees to it.
    """

    _decided: str | None = None

    def __init__(self, quads: Engine, software: SoftwareEngine) -> None:
        self._engines: dict[str, Engine] = {"quads": quads, "software": software}
        self._used: Engine = quads
        self._lost = ""
        self._home = threading.get_ident()
        self._seconds: dict[str, list[float]] = {"quads": [], "software": []}
        self._warmer = threading.Thread(target=software.warm, name="compile kernels", daemon=True)
        self._warmer.start()

    @property
    def name(self) -> str:
        """What drew the last frame."""
        return self._used.name

    @property
    def description(self) -> str:
        """That of the engine that drew the last frame, and why the other one was lost if it was."""
        return self._used.description + self._lost

    @property
    def timings(self) -> dict[str, float]:
        """Those of the engine that drew the last frame."""
        return self._used.timings

    @property
    def bound(self) -> bool:
        """Until only the software engine draws."""
        if len(self._engines) == 1:
            return next(iter(self._engines.values())).bound
        return FastestEngine._decided != "software" or self._warmer.is_alive()

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]:
        """The picture [H, W, 4], premultiplied, by the engine that is best at the moment."""
        self._used = self._engines[self._next()]
        started = time.perf_counter()
        try:
            picture = self._used.draw(raw, camera)
        except Exception as error:
            # a lost GL context or a kernel that cannot run here: the other engine draws the same picture
            if len(self._engines) == 1 or threading.get_ident() != self._home:
                raise
            self._lost = f" ({self._used.name} failed: {error})"
            self._drop(self._used.name)
            return self.draw(raw, camera)
        if FastestEngine._decided is None and len(self._engines) > 1:
            self._seconds[self._used.name].append(time.perf_counter() - started)
        return picture

    def close(self) -> None:
        """Close both."""
        for engine in self._engines.values():
            engine.close()

    def _drop(self, name: str) -> None:
        with contextlib.suppress(Exception):  # what is broken may not even close; the other engine must draw
            self._engines.pop(name).close()

    def _next(self) -> str:
        if len(self._engines) == 1:
            return next(iter(self._engines))
        if FastestEngine._decided is None:
            if self._warmer.is_alive():
                self._seconds["quads"].clear()  # while kernels compile, quads are slower than they will be
                return "quads"
            for name, seconds in self._seconds.items():
                if len(seconds) <= _TRIALS:  # the first is the one that touches new memory, and does not count
                    return name
            FastestEngine._decided = min(self._seconds, key=lambda name: median(self._seconds[name][1:]))
        elif FastestEngine._decided == "software" and self._warmer.is_alive():
            return "quads"
        return FastestEngine._decided
