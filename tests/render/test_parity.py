"""Every engine draws the picture of the float64 reference."""

from pathlib import Path

import moderngl
import numpy as np
import pytest
from gemheads.app.performing.portrait import portrait
from gemheads.models.gemfile import load_gem
from gemheads.render.camera import Camera
from gemheads.render.gaussians import RawGaussians, activate
from gemheads.render.reference import render_reference
from gemheads.render.software import SoftwareEngine
from gemheads.render.splats import SplatRenderer

from .scenes import awkward, kept, portrait_camera, psnr, shell, spoiled

AVATARS = Path(__file__).parents[2] / "assets" / "avatars"
SCENES = {"shell": (shell(60_000), portrait_camera()), "awkward": (awkward(4_000), portrait_camera(277, 190))}


@pytest.fixture(scope="module")
def references() -> dict[str, np.ndarray]:
    return {name: render_reference(activate(raw), camera) for name, (raw, camera) in SCENES.items()}


@pytest.mark.parametrize("scene", SCENES)
def test_software_draws_the_reference(scene: str, references: dict[str, np.ndarray]) -> None:
    assert psnr(SoftwareEngine().draw(*SCENES[scene]), references[scene]) >= 80


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(("precision", "least"), [("half", 58), ("single", 80)])
def test_quads_draw_the_reference(
    context: moderngl.Context, scene: str, precision: str, least: float, references: dict[str, np.ndarray]
) -> None:
    renderer = SplatRenderer(context, precision)  # pyright: ignore[reportArgumentType]
    assert psnr(renderer.draw(*SCENES[scene]), references[scene]) >= least
    renderer.close()


def test_parity_is_not_that_of_empty_pictures(references: dict[str, np.ndarray]) -> None:
    for image in references.values():
        assert 0.2 < image[..., 3].mean() < 0.999
        assert image[..., :3].std() > 0.05


def test_software_leaves_out_ruined_splats() -> None:
    raw, camera = shell(3_000), portrait_camera(96, 64)
    whole = SoftwareEngine().draw(kept(raw), camera)
    np.testing.assert_array_equal(SoftwareEngine().draw(spoiled(raw), camera), whole)


def test_quads_leave_out_ruined_splats(context: moderngl.Context) -> None:
    raw, camera = shell(3_000), portrait_camera(96, 64)
    renderer = SplatRenderer(context)
    whole = renderer.draw(kept(raw), camera).copy()
    np.testing.assert_array_equal(renderer.draw(spoiled(raw), camera), whole)
    renderer.close()


def test_engines_follow_other_sizes_and_counts(context: moderngl.Context) -> None:
    renderer, software = SplatRenderer(context, "single"), SoftwareEngine()
    for count, width, height in ((2_000, 64, 48), (1_024, 33, 70), (0, 20, 20), (5_000, 64, 48)):
        raw, camera = shell(count), portrait_camera(width, height)
        drawn = software.draw(raw, camera)
        assert drawn.shape == (height, width, 4)
        assert psnr(renderer.draw(raw, camera), drawn) >= 80
    renderer.close()


def test_no_splat_in_view_is_transparent(context: moderngl.Context) -> None:
    raw = shell(100)
    away = RawGaussians(
        raw.positions + np.float32([0, 0, 50]), raw.wxyz, raw.log_scales, raw.opacity_logits, raw.colors
    )
    renderer = SplatRenderer(context)
    for engine in (SoftwareEngine(), renderer):
        assert not engine.draw(away, portrait_camera(32, 32)).any()
    renderer.close()


def avatar() -> tuple[RawGaussians, Camera]:
    """The first shipped avatar at rest, in its portrait."""
    files = sorted(AVATARS.glob("*.gem"))
    if not files:
        pytest.skip(f"no avatar in {AVATARS}; make them with `make avatars`")
    gem = load_gem(files[0])
    return gem.compose(gem.rest_coefficients), portrait(gem.viewing, 512, 512)


def test_engines_draw_an_avatar(context: moderngl.Context) -> None:
    raw, camera = avatar()
    reference = render_reference(activate(raw), camera)
    assert psnr(SoftwareEngine().draw(raw, camera), reference) >= 80
    for precision, least in (("single", 80), ("half", 58)):
        renderer = SplatRenderer(context, precision)
        assert psnr(renderer.draw(raw, camera), reference) >= least
        renderer.close()
