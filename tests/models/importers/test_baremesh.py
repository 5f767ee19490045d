"""The bare mesh of a capture as splats: colours from its pictures, motion from its tracking."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.models.captures.layout import CaptureError
from gemheads.models.captures.reader import Capture, open_capture
from gemheads.models.captures.texels import texels_of
from gemheads.models.captures.texture import spread_shots, texel_colors
from gemheads.models.importers.adopt import adopt
from gemheads.models.importers.baremesh import capture_source
from gemheads.models.posing import pose_head
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine


def test_texels_get_the_colours_that_pictures_show(toy_capture: Path) -> None:
    capture = open_capture(toy_capture)
    texels = texels_of(capture.template, 32)
    colors, seen = texel_colors(capture, texels)
    assert seen.mean() > 0.95
    for part, wanted in enumerate(([0.75, 0.55, 0.45], [0.2, 0.3, 0.5], [0.9, 0.9, 0.85])):
        np.testing.assert_allclose(np.median(colors[seen & (texels.part == part)], 0), wanted, atol=0.08)


def test_hidden_texels_have_the_colours_of_neighbours_of_their_part(toy_capture: Path) -> None:
    capture = open_capture(toy_capture)
    from_one_side = replace(capture, train=tuple(shot for shot in capture.train if shot.camera_index == 0))
    texels = texels_of(capture.template, 32)
    colors, seen = texel_colors(from_one_side, texels)
    assert 0.3 < seen.mean() < 0.98
    for part in np.unique(texels.part):
        known = {tuple(color) for color in colors[seen & (texels.part == part)]}
        assert {tuple(color) for color in colors[~seen & (texels.part == part)]} <= known


def test_a_shadow_in_a_few_pictures_does_not_count(toy_capture: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(toy_capture, tmp_path / "shadowed")
    cv2.imwrite(str(folder / "images" / "00001_02.png"), np.zeros((64, 64, 3), np.uint8))
    clean, shadowed = (open_capture(place) for place in (toy_capture, folder))
    texels = texels_of(clean.template, 24)
    colors, seen = texel_colors(clean, texels)
    assert np.abs(texel_colors(shadowed, texels)[0] - colors)[seen].mean() < 0.01


def masked(capture: Path, to: Path, change: Callable[[np.ndarray], np.ndarray]) -> Capture:
    """The same capture with other masks."""
    folder = shutil.copytree(capture, to)
    for file in (folder / "fg_masks").iterdir():
        mask = cv2.imread(str(file), cv2.IMREAD_UNCHANGED)
        assert mask is not None
        cv2.imwrite(str(file), change(mask))
    return open_capture(folder)


def test_meshes_without_weights_are_named(toy_capture: Path, tmp_path: Path) -> None:
    folder, moments = shutil.copytree(toy_capture, tmp_path / "toy"), range(6)
    for lacking, said in (((3,), "00003.npz has no"), ((3, 5), "00003.npz and 1 more have no"), (moments, "it has no")):
        for moment in lacking:
            path = folder / "meshes" / f"{moment:05d}.npz"
            np.savez(path, **{name: values for name, values in np.load(path).items() if name != "arkit"})
        source = capture_source(open_capture(folder), 16)
        assert source.performance is None
        assert source.notes[0].startswith(f"{said} ARKit weights")


def test_soft_mattes_show_the_person_too(toy_capture: Path, tmp_path: Path) -> None:
    capture = masked(toy_capture, tmp_path / "soft", lambda mask: np.minimum(mask, 254))
    texels = texels_of(capture.template, 24)
    assert texel_colors(capture, texels)[1].mean() > 0.9


def test_masks_that_show_nobody_are_told(toy_capture: Path, tmp_path: Path) -> None:
    """As those that say 1 where the person is: the avatar would be grey."""
    capture = masked(toy_capture, tmp_path / "ones", lambda mask: np.minimum(mask, 1))
    with pytest.raises(CaptureError, match="no training picture shows any of the template"):
        texel_colors(capture, texels_of(capture.template, 24))


def test_shots_are_spread_over_moments_and_cameras(toy_capture: Path) -> None:
    shots = open_capture(toy_capture).train
    few = spread_shots(shots, 4)
    assert len({shot.timestep for shot in few}) == 4
    assert len({shot.camera_index for shot in few}) >= 3
    assert sorted(map(str, spread_shots(shots, 100))) == sorted(map(str, shots))


def test_an_avatar_of_the_bare_mesh_looks_like_its_pictures(toy_capture: Path) -> None:
    capture = open_capture(toy_capture)
    source = capture_source(capture, 24)
    assert source.moments == tuple(range(6))
    gem, _ = adopt(source, "Toy", 5)
    assert gem.uv_size == 24
    assert len({tuple(texel) for texel in gem.uv_index.tolist()}) == len(gem)
    assert gem.arkit_weights is not None
    used = np.flatnonzero(np.abs(gem.arkit_weights).max(1))
    assert used.tolist() == [2, 17], "the two that its performance has"
    shot = capture.test[2]
    tracked = capture.tracked(shot.timestep)
    assert tracked.arkit is not None
    raw = gem.compose(gem.arkit_coefficients(tracked.arkit))
    raw = pose_head(raw, gem.neck_weights, gem.neck_pivot, tracked.rotation, tracked.translation)
    image = over(SoftwareEngine().draw(raw, shot.camera), capture.background) / 255.0
    rgba = capture.read(shot) / 255.0
    picture = rgba[..., :3] * rgba[..., 3:] + 1 - rgba[..., 3:]
    assert -10 * np.log10(np.mean((image - picture) ** 2)) > 20
