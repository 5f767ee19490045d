"""The watch over OpenGL errors (tests/conftest.py) sees one, and a driver that dies is replaced by the other engine."""

import moderngl
import numpy as np
import pytest
from gemheads.render.camera import Camera
from gemheads.render.engines import FastestEngine, open_engine
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from gemheads.render.splats import SplatRenderer

from .scenes import portrait_camera, shell

pytest_plugins = ("pytester",)
RAW, CAMERA = shell(50), portrait_camera(32, 32)


def test_an_error_is_an_error(context: moderngl.Context) -> None:
    context.enable_direct(0xBAD)  # no such thing: GL_INVALID_ENUM
    assert context.error == "GL_INVALID_ENUM"
    assert context.error == "GL_NO_ERROR"  # asking clears it, and the watch stays quiet


def test_the_watch_sees_what_a_test_leaves_behind(pytester: pytest.Pytester, request: pytest.FixtureRequest) -> None:
    conftest = request.path.parents[1] / "conftest.py"
    pytester.makeconftest(conftest.read_text())
    pytester.makepyfile(
        """
        from gemheads.render.contexts import offscreen_context

        def test_torn():
            offscreen_context().enable_direct(0xBAD)

        def test_torn_and_closed():
            context = offscreen_context()
            context.enable_direct(0xBAD)
            context.release()

        def test_sound():
            offscreen_context().release()
        """
    )
    pytester.runpytest("-p", "no:cacheprovider").assert_outcomes(passed=3, errors=2)


def test_pictures_of_other_sizes_leave_no_error_behind(context: moderngl.Context) -> None:
    """A framebuffer that is released while it is bound: the next one that is made finds it missing."""
    renderer = SplatRenderer(context)
    for splats, side in ((50, 16), (50, 32), (20_000, 32), (50, 16)):
        renderer.draw(shell(splats), portrait_camera(side, side))
        with context:  # drawing lets go of it
            assert context.error == "GL_NO_ERROR"
    renderer.close()
    with context:
        context.simple_framebuffer((4, 4)).clear(1, 0, 0)
        assert context.error == "GL_NO_ERROR"


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> FastestEngine:
    """The real thing on the real GL."""
    monkeypatch.setattr(FastestEngine, "_decided", "quads")
    made = open_engine("auto")
    if not isinstance(made, FastestEngine):
        pytest.skip("no OpenGL here")
    return made


def test_a_context_that_is_lost_in_the_middle_of_the_show(engine: FastestEngine) -> None:
    before = engine.draw(RAW, CAMERA).copy()
    assert engine.name == "quads"
    lost = engine._engines["quads"]
    assert isinstance(lost, SplatRenderer)
    lost.close()  # all its objects are gone, as after a crash of the driver
    after = engine.draw(RAW, CAMERA)
    assert engine.name == "software"
    assert "quads failed" in engine.description
    assert np.abs(after - before).max() < 0.02
    engine.close()


def test_a_driver_that_cannot_compile_leaves_the_software_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    def torn(*_: object, **__: object) -> None:
        raise RuntimeError("GLSL Compiler failed")

    monkeypatch.setattr(SplatRenderer, "draw", torn)
    monkeypatch.setattr(FastestEngine, "_decided", "quads")
    engine = open_engine("auto")
    assert engine.draw(RAW, CAMERA).any()
    assert engine.name == "software"
    engine.close()


def test_a_driver_that_cannot_even_begin_leaves_the_software_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    def torn(*_: object, **__: object) -> None:
        raise RuntimeError("GLSL Compiler failed")

    monkeypatch.setattr(moderngl.Context, "program", torn)
    engine = open_engine("auto")
    assert isinstance(engine, SoftwareEngine)
    assert "GLSL Compiler failed" in engine.description
    assert engine.draw(RAW, CAMERA).any()


def test_kernels_that_fail_leave_quads(engine: FastestEngine, monkeypatch: pytest.MonkeyPatch) -> None:
    def torn(self: SoftwareEngine, raw: RawGaussians, camera: Camera) -> None:
        raise RuntimeError("LLVM failed")

    engine._warmer.join()
    monkeypatch.setattr(SoftwareEngine, "draw", torn)
    monkeypatch.setattr(FastestEngine, "_decided", "software")
    assert engine.draw(RAW, CAMERA).any()
    assert engine.name == "quads"
    engine.close()
