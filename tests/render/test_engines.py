"""Opening engines, and the choice between them."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import moderngl
import numpy as np
import pytest
from gemheads.render import contexts
from gemheads.render.camera import Camera
from gemheads.render.culling import view_depths
from gemheads.render.engines import FastestEngine, open_engine
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from gemheads.render.sorting import front_to_back
from gemheads.render.splats import SplatRenderer

from .scenes import portrait_camera, shell

RAW, CAMERA = shell(50), portrait_camera(16, 16)


class Counting:
    """An engine that draws nothing and counts how often."""

    timings: dict[str, float] = {}  # noqa: RUF012
    description = "for tests"

    def __init__(self, name: str, fails: bool = False) -> None:
        self.name, self.fails, self.bound = name, fails, name == "quads"
        self.drawn, self.closed = 0, False
        self.may_warm = threading.Event()

    def draw(self, raw: RawGaussians, camera: Camera) -> np.ndarray:
        self.drawn += 1
        if self.fails:
            raise RuntimeError("lost")
        return np.zeros((camera.height, camera.width, 4), np.float32)

    def warm(self) -> None:
        self.may_warm.wait(5)

    def close(self) -> None:
        self.closed = True


@pytest.fixture(autouse=True)
def undecided(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FastestEngine, "_decided", None)


def fastest(quads: Counting, software: Counting) -> FastestEngine:
    return FastestEngine(quads, software)  # pyright: ignore[reportArgumentType]


def test_quads_draw_until_the_kernels_are_ready_then_both_are_tried() -> None:
    quads, software = Counting("quads"), Counting("software")
    engine = fastest(quads, software)
    for _ in range(20):
        engine.draw(RAW, CAMERA)
    assert (quads.drawn, software.drawn) == (20, 0)
    software.may_warm.set()
    engine._warmer.join()
    for _ in range(20):
        engine.draw(RAW, CAMERA)
    assert FastestEngine._decided in ("quads", "software")
    assert engine.name == FastestEngine._decided
    assert software.drawn >= 4
    engine.close()
    assert quads.closed
    assert software.closed


@pytest.mark.parametrize("lost", [False, True])
def test_times_are_kept_only_while_there_is_a_choice(lost: bool) -> None:
    software = Counting("software", fails=lost)
    engine = fastest(Counting("quads"), software)
    software.may_warm.set()
    engine._warmer.join()
    for _ in range(50):
        engine.draw(RAW, CAMERA)
    assert sum(map(len, engine._seconds.values())) <= 8


@pytest.mark.parametrize("lost", ["quads", "software"])
def test_the_other_engine_takes_over(lost: str) -> None:
    made = {name: Counting(name, fails=name == lost) for name in ("quads", "software")}
    engine = fastest(made["quads"], made["software"])
    made["software"].may_warm.set()
    engine._warmer.join()
    for _ in range(10):
        assert engine.draw(RAW, CAMERA).shape == (16, 16, 4)
    assert engine.name != lost
    assert engine.description == f"for tests ({lost} failed: lost)"
    assert made[lost].drawn == 1
    assert made[lost].closed


def test_an_engine_that_fails_in_another_thread_is_replaced_in_its_own() -> None:
    quads, software = Counting("quads"), Counting("software", fails=True)
    engine = fastest(quads, software)
    assert engine.bound, "quads draw first"
    software.may_warm.set()
    engine._warmer.join()
    FastestEngine._decided = "software"
    assert not engine.bound
    with ThreadPoolExecutor(1) as beside, pytest.raises(RuntimeError, match="lost"):
        beside.submit(engine.draw, RAW, CAMERA).result()
    assert quads.drawn == 0, "an OpenGL context is of one thread"
    engine.draw(RAW, CAMERA)
    assert engine.name == "quads"
    assert engine.bound


def test_both_lost_is_an_error() -> None:
    engine = fastest(Counting("quads", fails=True), Counting("software", fails=True))
    with pytest.raises(RuntimeError, match="lost"):
        engine.draw(RAW, CAMERA)


def test_auto_without_opengl_is_software(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> None:
        raise contexts.NoOpenGLError("none here")

    monkeypatch.setattr(contexts, "offscreen_context", none)
    engine = open_engine("auto")
    assert isinstance(engine, SoftwareEngine)
    assert "none here" in engine.description
    with pytest.raises(contexts.NoOpenGLError):
        open_engine("quads")


def test_missing_opengl_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(**_: object) -> None:
        raise Exception("libEGL.so.1: cannot open shared object file")

    monkeypatch.setattr(contexts.moderngl, "create_context", broken)
    with pytest.raises(contexts.NoOpenGLError, match=r"libEGL.*install OpenGL"):
        contexts.offscreen_context()


def test_unknown_engine() -> None:
    with pytest.raises(ValueError, match="auto, quads and software"):
        open_engine("vulkan")  # pyright: ignore[reportArgumentType]


def test_software_needs_no_opengl(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "moderngl", None)
    monkeypatch.delitem(sys.modules, "gemheads.render.contexts", raising=False)
    assert open_engine("software").draw(RAW, CAMERA).any()


def test_auto_draws_at_once_and_closes() -> None:
    engine = open_engine("auto")
    assert engine.draw(RAW, CAMERA).any()
    assert engine.timings
    engine.close()


def test_warming_compiles_what_drawing_needs() -> None:
    engine = SoftwareEngine()
    engine.warm()
    from gemheads.render import software

    kernels = (
        software._project,
        software.count_pairs,
        software.run_of_tiles,
        software.fill_pairs,
        software._rasterise,
        software.front_to_back,
    )
    engine.draw(RAW, CAMERA)
    assert [len(kernel.signatures) for kernel in kernels] == [1] * len(kernels)


def test_what_quads_need_can_be_compiled_ahead() -> None:
    """After ``warm`` a frame compiles nothing more: a window that draws it would stand still meanwhile."""
    engine = open_engine("quads")
    kernels: list[Any] = [view_depths, front_to_back]
    SplatRenderer.warm()
    known = [len(kernel.signatures) for kernel in kernels]
    engine.draw(RAW, CAMERA)
    engine.close()
    assert [len(kernel.signatures) for kernel in kernels] == known


def test_quads_draw_in_a_context_that_is_there_and_leave_it_open(context: moderngl.Context) -> None:
    engine = open_engine("quads", context)
    picture = engine.draw(RAW, CAMERA).copy()
    engine.close()
    with context:
        frame = context.simple_framebuffer((4, 4))
        frame.clear(1, 0, 0)
        assert frame.read()[:3] == b"\xff\x00\x00"
    own = open_engine("quads")
    np.testing.assert_array_equal(own.draw(RAW, CAMERA), picture)
    own.close()
