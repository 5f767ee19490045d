"""Who draws: our engines in this process, the peers in the page; all behind one face."""

import queue
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from chromium import Chromium
from gemheads.render.camera import Camera
from gemheads.render.compositing import over
from gemheads.render.engines import Engine
from gemheads.render.gaussians import RawGaussians
from numpy.typing import NDArray
from pagecamera import lens_of, pose_of
from server import PageServer
from trouble import Trouble

ANSWER_SECONDS = 180.0
"""The first picture of a viewer may have to load and compile."""
LOOK_SECONDS = 1.0


@dataclass(frozen=True)
class Times:
    """Milliseconds of one frame."""

    sort: float
    """Until the order of the splats was known; of the peers, with their way to their sorters and back."""
    frame: float
    """All of it: sorted, drawn, and done by the GPU."""


class Viewer(Protocol):
    """Draws the same splats from any camera."""

    @property
    def name(self) -> str:
        """As the table has it."""
        ...

    def renderer(self, camera: Camera) -> str:
        """What draws, as it names itself."""
        ...

    def picture(self, camera: Camera) -> NDArray[np.uint8]:
        """[H, W, 3] over the background."""
        ...

    def frames(self, cameras: Sequence[Camera]) -> list[Times]:
        """One frame for each camera; all cameras have the same lens."""
        ...


class OurViewer:
    """One of our engines. Its frame ends with the picture in memory, which the peers' frames do not."""

    def __init__(self, engine: Engine, splats: RawGaussians, background: tuple[float, float, float]) -> None:
        self.name = engine.name
        self._engine = engine
        self._splats = splats
        self._background = background

    def renderer(self, camera: Camera) -> str:
        """The engine's own description."""
        return self._engine.description

    def picture(self, camera: Camera) -> NDArray[np.uint8]:
        """[H, W, 3] over the background."""
        return over(self._engine.draw(self._splats, camera), self._background)

    def frames(self, cameras: Sequence[Camera]) -> list[Times]:
        """One frame for each camera."""
        times = []
        for camera in cameras:
            began = time.perf_counter()
            self._engine.draw(self._splats, camera)
            took = time.perf_counter() - began
            times.append(Times(1e3 * self._engine.timings["sort"], 1e3 * took))
        return times


class PageViewer:
    """One of the viewers of the page."""

    def __init__(self, name: str, server: PageServer, browser: Chromium) -> None:
        """``name``: as the page's script has it."""
        self.name = name
        self._server = server
        self._browser = browser

    def renderer(self, camera: Camera) -> str:
        """What WebGL says that it runs on."""
        return str(self._asked("renderer", [camera])["renderer"])

    def picture(self, camera: Camera) -> NDArray[np.uint8]:
        """[H, W, 3] as the canvas has it, background included."""
        pixels = self._asked("picture", [camera])["pixels"]
        return np.frombuffer(pixels, np.uint8).reshape(camera.height, camera.width, 4)[::-1, :, :3]

    def frames(self, cameras: Sequence[Camera]) -> list[Times]:
        """One frame for each camera."""
        return [Times(**frame) for frame in self._asked("frames", cameras)["frames"]]

    def _asked(self, wants: str, cameras: Sequence[Camera]) -> dict[str, Any]:
        poses = [pose_of(camera) for camera in cameras]
        self._server.tasks.put({"viewer": self.name, "wants": wants, "lens": lens_of(cameras[0]), "poses": poses})
        answer = self._answer()
        if "error" in answer:
            raise Trouble(f"{self.name} failed in the page: {answer['error']}")
        return answer

    def _answer(self) -> dict[str, Any]:
        until = time.monotonic() + ANSWER_SECONDS
        while time.monotonic() < until:
            try:
                return self._server.next_answer(LOOK_SECONDS)
            except queue.Empty:
                self._browser.check()
        raise Trouble(f"{self.name} gave no answer for {ANSWER_SECONDS:.0f} s; is the machine very busy?")
