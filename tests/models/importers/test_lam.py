"""LAM avatars: a small one made here, and the two real ones where they are at hand."""

import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.performing.portrait import portrait
from gemheads.models.heads.expressions import weights_of
from gemheads.models.heads.performance import perform
from gemheads.models.importers.adopt import adopt
from gemheads.models.importers.foreign import ForeignFormatError
from gemheads.models.importers.lam import YAW_LIMIT_DEG, load_lam
from gemheads.render.gaussians import RawGaussians
from gemheads.render.rotations import matrix_from_wxyz, normalized
from gemheads.render.software import SoftwareEngine

REAL = Path(__file__).resolve().parents[4] / "shared" / "data" / "lam"


def covariances(raw: RawGaussians) -> np.ndarray:
    """[N, 3, 3]"""
    axes = matrix_from_wxyz(raw.wxyz.astype(np.float64)) * np.exp(raw.log_scales.astype(np.float64))[:, None]
    return axes @ axes.swapaxes(1, 2)


class TestSmall:
    def test_splats_ride_on_their_vertices(self, lam: Any, tmp_path: Path) -> None:
        avatar = load_lam(lam.write(tmp_path / "small"))
        assert set(avatar.names) == {"jawOpen", "browInnerUp"}
        weights = weights_of(jawOpen=0.5, browInnerUp=1.0, tongueOut=1.0)
        moved = avatar.frame(weights).positions - avatar.rest.positions
        np.testing.assert_allclose(moved, 0.5 * lam.shapes["jawOpen"] + lam.shapes["browInnerUp"], atol=1e-7)
        shift = avatar.rest.positions - lam.vertices - lam.splats.positions
        np.testing.assert_allclose(shift, np.tile(shift[0], (len(shift), 1)), atol=1e-6)
        np.testing.assert_allclose(avatar.rest.colors, lam.splats.colors, atol=1e-6)

    def test_at_rest_nothing_turns(self, lam: Any, tmp_path: Path) -> None:
        avatar = load_lam(lam.write(tmp_path / "small"))
        rest = avatar.frame(np.zeros(52))
        np.testing.assert_allclose(covariances(rest), covariances(lam.splats), rtol=1e-4, atol=1e-9)

    def test_a_surface_that_turns_takes_its_splats_along(self, lam: Any, tmp_path: Path) -> None:
        angle = 0.4
        turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        whole = (lam.vertices @ turn.T - lam.vertices).astype(np.float32)
        view = lam.tree["bufferViews"][lam.tree["accessors"][2]["bufferView"]]
        lam.buffer[view["byteOffset"] : view["byteOffset"] + view["byteLength"]] = whole.tobytes()
        frame = load_lam(lam.write(tmp_path / "turning")).frame(weights_of(jawOpen=1.0))
        np.testing.assert_allclose(covariances(frame), turn @ covariances(lam.splats) @ turn.T, rtol=1e-3, atol=1e-8)

    def test_a_surface_that_stretches_stretches_its_splats(self, lam: Any, tmp_path: Path) -> None:
        wide = (lam.vertices * np.float32([0, 0.5, 0])).astype(np.float32)
        view = lam.tree["bufferViews"][lam.tree["accessors"][2]["bufferView"]]
        lam.buffer[view["byteOffset"] : view["byteOffset"] + view["byteLength"]] = wide.tobytes()
        upright = np.tile(np.float32([1, 0, 0, 0]), (len(lam.vertices), 1))
        lam.splats = replace(lam.splats, wxyz=upright)
        frame = load_lam(lam.write(tmp_path / "long")).frame(weights_of(jawOpen=1.0))
        grown = frame.log_scales - lam.splats.log_scales
        np.testing.assert_allclose(grown[:, 1], np.log(1.5), atol=1e-3)
        np.testing.assert_allclose(grown[:, [0, 2]], 0, atol=0.02)

    def test_invisible_splats_are_left_out(self, lam: Any, tmp_path: Path) -> None:
        lam.splats.opacity_logits[10:20] = -8
        avatar = load_lam(lam.write(tmp_path / "small"))
        assert len(avatar) == len(lam.vertices) - 10
        moved = avatar.frame(weights_of(jawOpen=1.0)).positions - avatar.rest.positions
        np.testing.assert_allclose(moved, np.delete(lam.shapes["jawOpen"], np.s_[10:20], 0), atol=1e-7)

    def test_blobs_in_the_air_behind_the_head_are_left_out(self, lam: Any, tmp_path: Path) -> None:
        whole = load_lam(lam.write(tmp_path / "whole"))
        lam.splats.positions[100] = (0, 0, -0.25)
        lam.splats.positions[130:136] = (0, 0, -0.25) - lam.vertices[130:136] + lam.vertices[130]
        avatar = load_lam(lam.write(tmp_path / "small"))
        assert avatar.floaters == 1, "six together are no floaters"
        np.testing.assert_array_equal(avatar.rest.wxyz, np.delete(whole.rest.wxyz, 100, 0))
        assert any("hang in the air" in note for note in avatar.source(np.zeros((1, 52), np.float32)).notes)

    def test_nothing_to_see_is_said(self, lam: Any, tmp_path: Path) -> None:
        lam.splats.opacity_logits[:] = -9
        with pytest.raises(ForeignFormatError, match="none of its splats can be seen"):
            load_lam(lam.write(tmp_path / "small"))

    def test_a_splat_too_few_is_said(self, lam: Any, tmp_path: Path) -> None:
        parts = (lam.splats.positions, lam.splats.wxyz, lam.splats.log_scales, lam.splats.opacity_logits)
        lam.splats = RawGaussians(*(part[:-1] for part in parts), lam.splats.colors[:-1])
        with pytest.raises(ForeignFormatError, match="143 splats for 144 vertices; take both files"):
            load_lam(lam.write(tmp_path / "small"))

    def test_the_gem_answers_arkit_weights_as_the_avatar_does(self, lam: Any, tmp_path: Path) -> None:
        lam.splats.wxyz[::2] *= -1  # files hold either sign
        avatar = load_lam(lam.write(tmp_path / "small"))
        performance = perform(np.random.default_rng(0), 160)
        gem, distilled = adopt(avatar.source(performance), "Small", 8, {"consent": "a sheet"})
        assert gem.name == "Small"
        assert gem.about == {"consent": "a sheet"}
        assert distilled.frames == 160
        assert distilled.variance_kept["position"][1] > 0.99999, "two shapes, two dimensions"
        for weights in (np.zeros(52), weights_of(jawOpen=0.7), weights_of(browInnerUp=1.0, jawOpen=0.2)):
            played = gem.compose(gem.arkit_coefficients(weights))
            wanted = avatar.frame(weights)
            np.testing.assert_allclose(played.positions, wanted.positions, atol=2e-5)
            same = np.abs((normalized(played.wxyz) * normalized(wanted.wxyz)).sum(1))
            assert same.min() > np.cos(np.radians(1.0) / 2), "splats turn as they should, to a degree"
        assert gem.viewing.yaw_limit_deg == YAW_LIMIT_DEG
        assert gem.neck_weights[avatar.rest.positions[:, 1] > -0.05].min() == 1
        assert gem.neck_weights[avatar.rest.positions[:, 1] < -0.17].max() == 0


@pytest.mark.parametrize("name", ["nyx", "james"])
def test_twenty_components_reproduce_a_real_avatar(name: str, tmp_path: Path) -> None:
    """On expressions it was not distilled from, seen from the front, distilled from few frames."""
    archive = REAL / f"{name}.zip"
    if not archive.is_file():
        pytest.skip(f"needs {archive.name} in ../shared/data/lam; it cannot ship (CC BY-NC)")
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(tmp_path)
    avatar = load_lam(next(tmp_path.glob("*/skin.glb")).parent)
    assert len(avatar.names) == 51
    source = avatar.source(perform(np.random.default_rng(0), 240)[::3])
    gem, _ = adopt(replace(source, performance=None), name, 20)
    engine, camera = SoftwareEngine(), portrait(gem.viewing, 256, 256)
    rest = engine.draw(avatar.rest, camera).copy()
    errors, motion = [], []
    for weights in perform(np.random.default_rng(99), 300)[-8:]:
        frame = avatar.frame(weights)
        truth = engine.draw(frame, camera).copy()
        errors.append(float(((engine.draw(gem.compose(gem.project(frame)), camera) - truth) ** 2).mean()))
        motion.append(float(((rest - truth) ** 2).mean()))
    assert -10 * np.log10(np.mean(errors)) >= 40
    assert np.mean(errors) < np.mean(motion) / 5, "the avatar did move"
