"""The bare mesh of a capture as splats: colours from its pictures, motion from its tracking."""

from pathlib import Path

import numpy as np
from gemheads.models.arkit import NAMES
from gemheads.models.captures.baremesh import capture_source
from gemheads.models.captures.reader import open_capture
from gemheads.models.captures.texels import texels_of
from gemheads.models.captures.texture import spread_shots, texel_colors
from gemheads.models.importers.adopt import adopt
from gemheads.models.posing import pose_head
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine


def test_texels_get_the_colours_that_pictures_show_and_hidden_ones_their_neighbours(ball_capture: Path) -> None:
    capture = open_capture(ball_capture)
    texels = texels_of(capture.template, 24)
    colors, seen = texel_colors(capture, texels)
    places = texels.spread(capture.template.uv)
    truth = 0.5 + 0.4 * np.sin(2 * np.pi * places[:, :1] + [0, 2, 4] + 6 * places[:, 1:])
    assert 0.4 < seen.mean() < 0.9, "nobody saw its back"
    assert np.abs(colors - truth)[seen].mean() < 0.1
    assert np.abs(colors - truth)[seen].mean() < 0.5 * np.abs(colors - truth)[~seen].mean()


def test_a_shadow_in_a_few_pictures_does_not_count(ball_capture: Path, tmp_path: Path) -> None:
    import shutil

    import cv2

    folder = shutil.copytree(ball_capture, tmp_path / "shadowed")
    cv2.imwrite(str(folder / "images" / "00001_02.png"), np.zeros((64, 64, 3), np.uint8))
    clean, shadowed = (open_capture(place) for place in (ball_capture, folder))
    texels = texels_of(clean.template, 24)
    colors, seen = texel_colors(clean, texels)
    assert np.abs(texel_colors(shadowed, texels)[0] - colors)[seen].mean() < 0.01


def test_shots_are_spread_over_moments_and_cameras(ball_capture: Path) -> None:
    shots = open_capture(ball_capture).train
    few = spread_shots(shots, 4)
    assert len({shot.timestep for shot in few}) == 4
    assert len({shot.camera_index for shot in few}) >= 3
    assert sorted(map(str, spread_shots(shots, 100))) == sorted(map(str, shots))


def test_an_avatar_of_the_bare_mesh_looks_like_its_pictures(ball_capture: Path) -> None:
    capture = open_capture(ball_capture)
    source = capture_source(capture, 24)
    assert source.moments == tuple(range(6))
    gem, _ = adopt(source, "Ball", 5)
    assert gem.uv_size == 24
    assert len({tuple(texel) for texel in gem.uv_index.tolist()}) == len(gem)
    assert gem.arkit_weights is not None
    assert np.abs(gem.arkit_weights[NAMES.index("jawOpen")]).max() > 10 * np.abs(gem.arkit_weights[0]).max()
    shot = capture.test[2]
    tracked = capture.tracked(shot.timestep)
    assert tracked.arkit is not None
    raw = gem.compose(gem.arkit_coefficients(tracked.arkit))
    raw = pose_head(raw, gem.neck_weights, gem.neck_pivot, tracked.rotation, tracked.translation)
    image = over(SoftwareEngine().draw(raw, shot.camera), capture.background) / 255.0
    rgba = capture.read(shot) / 255.0
    picture = rgba[..., :3] * rgba[..., 3:] + 1 - rgba[..., 3:]
    assert -10 * np.log10(np.mean((image - picture) ** 2)) > 20
