"""The studio: pictures that are the same every time, light that follows expression and view, a tracker that errs."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.captures.reader import open_capture
from gemheads.models.captures.texels import texels_of
from gemheads.models.captures.uvraster import cover
from gemheads.models.captures.writer import CaptureWriter
from gemheads.models.heads.expressions import weights_of
from gemheads.models.studio.acting import EMOTIONS_SHOWN, VISEMES_SPOKEN, perform
from gemheads.models.studio.drawing import Painter
from gemheads.models.studio.moment import Act, Moment, Stage
from gemheads.models.studio.rig import frontal, rig
from gemheads.models.studio.shoot import Plan, shoot
from gemheads.models.studio.subject import FOLDER, Subject, SubjectError, load_subject
from gemheads.models.studio.tracking import TrackingNoise
from gemheads.render.camera import Camera, orbit

STILL = np.zeros(3, np.float32)
SMALL = Plan(cameras=3, width=48, height=40, train=2, test=1, tracking_noise_m=1e-3)


@cache
def ada() -> Subject:
    return load_subject("ada")


@cache
def painter() -> Painter:
    return Painter(Stage(ada()))


@cache
def moment(**weights: float) -> Moment:
    return painter().stage.moment(Act(weights_of(**weights), STILL, STILL))


def camera(yaw: float = 0, size: int = 160) -> Camera:
    return orbit(ada().viewing.target, 1.0, yaw, 3, 20, size, size)


def test_the_subject_is_small_and_moves() -> None:
    assert (FOLDER / "ada.npz").stat().st_size <= 3e6
    rest = ada().puppet.pose(np.zeros(52, np.float32))
    for name in NAMES:
        assert np.abs(ada().puppet.pose(weights_of(**{name: 1.0})) - rest).max() > 5e-4, name
    assert set(np.unique(ada().template.parts)) == {0, 1, 2, 3}


def test_a_missing_subject_is_said() -> None:
    with pytest.raises(SubjectError, match="there are ada"):
        load_subject("nobody")


def test_the_map_has_no_overlap_and_the_face_most_room() -> None:
    template = ada().template
    size = 512
    owners, _ = cover(template.uv, template.uv_triangles, size)
    a, b, c = (template.uv[template.uv_triangles[:, k]].astype(float) for k in range(3))
    area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    covered = (owners >= 0).sum() / size**2
    assert area.sum() == pytest.approx(covered, rel=0.01)
    middle = template.vertices[template.triangles].mean(1)
    face = (middle[:, 2] > 0.06) & (middle[:, 1] > -0.09) & (middle[:, 1] < 0.1) & (template.parts == 0)
    p, q, r = (template.vertices[template.triangles[:, k]].astype(float) for k in range(3))
    surface = 0.5 * np.linalg.norm(np.cross(q - p, r - p), axis=1)
    rest = (template.parts == 0) & ~face
    assert area[face].sum() / surface[face].sum() > 2.5 * area[rest].sum() / surface[rest].sum()
    assert len(texels_of(template, 64)) > 0.6 * 64**2


def test_pictures_are_the_same_every_time() -> None:
    first = painter().draw(moment(), camera())
    again = Painter(Stage(ada())).draw(Stage(ada()).moment(Act(weights_of(), STILL, STILL)), camera())
    np.testing.assert_array_equal(first, again)


def test_alpha_is_the_head() -> None:
    picture = painter().draw(moment(), camera())
    assert picture.dtype == np.float32
    assert picture[80, 80, 3] == 1
    assert picture[2, 2].max() == 0
    assert (picture[..., :3] <= picture[..., 3:] + 1e-6).all()
    soft = (picture[..., 3] > 0) & (picture[..., 3] < 1)
    assert 0.002 < soft.mean() < 0.1


def test_shadows_move_with_the_expression() -> None:
    """The light on the throat and in the mouth, at vertices that do not themselves move much."""
    tracked = ada().tracked
    rest, opened = moment(), moment(jawOpen=0.8)
    away = np.linalg.norm(opened.vertices[:tracked] - rest.vertices[:tracked], axis=1)
    change = np.abs(opened.light[:tracked] - rest.light[:tracked]).max(1)
    assert change[away < 1e-3].max() > 0.1
    assert np.median(change[away < 1e-5]) < 0.01
    assert rest.light.min() >= 0


def test_shadows_move_with_the_head() -> None:
    turned = painter().stage.moment(Act(weights_of(), np.array([0, 0.4, 0], np.float32), STILL))
    assert np.abs(turned.light - moment().light).max() > 0.15


def test_compressed_skin_folds() -> None:
    assert moment().folds.max() < 1e-6
    frown, smile = moment(browDown=1.0), moment(mouthSmile=1.0, cheekSquint=1.0)
    vertices = ada().template.vertices
    eyes = ada().puppet.eye_centers[:, 1].mean()
    between = (
        (np.abs(vertices[:, 0]) < 0.012) & (np.abs(vertices[:, 1] - eyes - 0.015) < 0.012) & (vertices[:, 2] > 0.07)
    )
    assert frown.folds[: len(vertices)][between].max() > 0.2
    assert smile.folds[: len(vertices)][between].max() < 0.2


def test_folds_show_in_the_picture() -> None:
    from dataclasses import replace

    frown = moment(browDown=1.0, noseSneer=1.0)
    flat = replace(frown, folds=np.zeros_like(frown.folds))
    close = orbit((0, 0.03, 0.1), 1.0, 0, 3, 6, 160, 160)
    difference = np.abs(painter().draw(frown, close) - painter().draw(flat, close)).max(-1)
    assert (difference > 0.03).mean() > 0.01


def test_skin_shines_with_the_view() -> None:
    """The same point of the forehead from three sides: its light is the same, its colour is not."""
    vertices = ada().template.vertices
    point = vertices[np.argmin(np.linalg.norm(vertices - [0.0, 0.07, 0.115], axis=1))]
    seen = []
    for yaw in (-45, 0, 45):
        view = camera(yaw)
        x, y, z = view.world_to_camera[:3, :3] @ point + view.world_to_camera[:3, 3]
        column, row = int(view.fx * x / z + view.cx), int(view.fy * y / z + view.cy)
        seen.append(painter().draw(moment(), view)[row - 2 : row + 3, column - 2 : column + 3, :3].mean((0, 1)))
    assert np.ptp(seen, axis=0).max() > 0.02


def test_eyes_have_glints() -> None:
    center = ada().puppet.eye_centers[0]
    close = orbit(center, 1.0, 0, 0, 2.2, 120, 120)
    picture = painter().draw(moment(), close)[..., :3].min(-1)
    assert (picture > 0.85).sum() > 4


def test_sequences_are_repeatable_plausible_and_disjoint() -> None:
    train, test = perform("train", 60, 3), perform("test", 24, 3)
    assert not train[0].arkit.any()
    assert not train[0].rotation.any()
    np.testing.assert_array_equal(train[40].arkit, perform("train", 60, 3)[40].arkit)
    assert np.abs(train[40].arkit - perform("train", 60, 4)[40].arkit).max() > 0.05
    assert not set(EMOTIONS_SHOWN["train"]) & set(EMOTIONS_SHOWN["test"])
    assert not set(VISEMES_SPOKEN["train"]) & set(VISEMES_SPOKEN["test"])
    for act in (*train, *test):
        assert 0 <= act.arkit.min() <= act.arkit.max() <= 1
        assert np.degrees(np.linalg.norm(act.rotation)) < 35
        assert np.linalg.norm(act.translation) < 0.03
    near = min(np.abs(a.arkit - b.arkit).max() for a in train for b in test if b.arkit.max() > 0.5)
    assert near > 0.05


def test_cameras_stand_before_the_face() -> None:
    cameras = rig(16, 80, 60, ada().viewing)
    assert len({tuple(view.center.round(6)) for view in cameras}) == 16
    assert all(view.center[2] > 0.1 for view in cameras)
    assert abs(cameras[frontal(cameras)].center[0]) < 0.15


def test_the_tracker_errs_smoothly_and_about_zero() -> None:
    points = ada().template.vertices[::40]
    noise = TrackingNoise(1.5e-3, 5)
    errors = np.stack([noise.at(points, timestep) for timestep in range(300)])
    assert np.sqrt((errors**2).sum(-1).mean()) == pytest.approx(1.5e-3, rel=0.15)
    assert np.abs(errors.mean((0, 1))).max() < 2e-4
    step = np.linalg.norm(np.diff(errors, axis=0), axis=-1).mean()
    assert step < 1.0e-3
    near = noise.at(points + np.float32(2e-3), 0)
    along = np.linalg.norm(near - errors[0], axis=1)
    assert np.median(along) < 3e-4
    np.testing.assert_array_equal(errors[7], TrackingNoise(1.5e-3, 5).at(points, 7))


def test_a_capture_is_whole_and_goes_on(tmp_path: Path) -> None:
    steps: list[tuple[int, int]] = []
    writer = CaptureWriter(tmp_path)
    assert shoot(ada(), SMALL, writer, lambda _, done, total: steps.append((done, total))).drawn == 9
    assert steps[0] == (0, 9)
    assert steps[-1] == (9, 9)
    capture = open_capture(tmp_path)
    assert (len(capture.train), len(capture.val), len(capture.test)) == (4, 2, 3)
    assert {shot.camera_index for shot in capture.val} == {1}
    assert capture.viewing().target == pytest.approx(ada().viewing.target)
    tracked, truth = capture.tracked(1), capture.truth(1)
    assert truth is not None
    assert tracked.arkit is not None
    stage = painter().stage
    exact = stage.vertices(Act(tracked.arkit, tracked.rotation, tracked.translation))[: ada().tracked]
    np.testing.assert_allclose(truth, exact, atol=1e-6)
    bare = ada().puppet.pose(tracked.arkit)[: ada().tracked]
    off = np.linalg.norm(tracked.vertices - bare, axis=1)
    assert 3e-4 < np.sqrt((off**2).mean()) < 2e-3

    picture = tmp_path / "images" / "00001_02.png"
    before = picture.read_bytes()
    picture.unlink()
    assert shoot(ada(), SMALL, writer, lambda *_: None).drawn == 1
    assert picture.read_bytes() == before
