"""Any values whatever: no engine crashes, hangs, or draws anything but colours and coverage in range."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from gemheads.render.splats import SplatRenderer
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from .scenes import portrait_camera, shell

CAMERA = portrait_camera(37, 21)
COUNT = 6


def _raw(values: st.SearchStrategy[float]) -> st.SearchStrategy[RawGaussians]:
    def array(*shape: int) -> st.SearchStrategy[np.ndarray]:
        return arrays(np.float32, shape, elements=values)

    # what a colour may be besides is the avatar's: only numbers that are none are the engine's to leave out
    channel = st.floats(0, 1, width=32) | st.sampled_from([np.nan, np.inf, -np.inf])
    colors = arrays(np.float32, (COUNT, 3), elements=channel)
    return st.builds(RawGaussians, array(COUNT, 3), array(COUNT, 4), array(COUNT, 3), array(COUNT), colors)


anything = _raw(st.floats(width=32))
near_the_limits = _raw(st.floats(-20, 5, width=32) | st.sampled_from([0.0, -20.0, 5.0, 100.0, -100.0]))
near_the_camera = _raw(st.floats(-1, 1, width=32))


def assert_is_a_picture(image: np.ndarray) -> None:
    assert np.isfinite(image).all()
    assert image.min() >= -1e-3
    assert image.max() <= 1 + 1e-3
    assert (image[..., :3] <= image[..., 3:] + 2e-3).all()


@settings(max_examples=200, deadline=None)
@given(raw=anything | near_the_limits | near_the_camera)
def test_software_draws_a_picture_of_anything(raw: RawGaussians) -> None:
    assert_is_a_picture(SoftwareEngine().draw(raw, CAMERA))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(raw=anything | near_the_limits | near_the_camera)
def test_quads_draw_a_picture_of_anything(context: moderngl.Context, raw: RawGaussians) -> None:
    renderer = SplatRenderer(context, "single")
    drawn = renderer.draw(raw, CAMERA)
    assert_is_a_picture(drawn)
    # a splat exactly at the least alpha may fall on either side; anything more is a difference of meaning
    assert np.abs(drawn - SoftwareEngine().draw(raw, CAMERA)).max() <= 0.01
    renderer.close()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_splat_without_a_colour_is_left_out(context: moderngl.Context, value: float) -> None:
    raw = shell(50)
    colors, logits = raw.colors.copy(), raw.opacity_logits.copy()
    colors[::5, 1], logits[::5] = value, -100
    renderer = SplatRenderer(context)
    for engine in (SoftwareEngine(), renderer):
        without = engine.draw(replace(raw, opacity_logits=logits), CAMERA).copy()
        np.testing.assert_array_equal(engine.draw(replace(raw, colors=colors), CAMERA), without)
    renderer.close()


@pytest.mark.parametrize("most", [1, 100])
def test_what_splats_that_fill_the_picture_take_is_bounded(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    raw = shell(50)
    raw = replace(raw, log_scales=np.zeros_like(raw.log_scales), opacity_logits=np.full_like(raw.opacity_logits, -4))
    whole = SoftwareEngine().draw(raw, CAMERA)
    monkeypatch.setattr("gemheads.render.software._PAIRS", most)
    engine = SoftwareEngine()
    np.testing.assert_array_equal(engine.draw(raw, CAMERA), whole)
    assert len(engine._pairs) <= max(most, len(raw))
