"""The bench beside other viewers gives them our camera, and its pages ask for nothing that they are not given."""

import importlib.util
import re
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from gemheads.render.camera import Camera, orbit
from gemheads.render.gaussians import Gaussians
from gemheads.render.projection import DILATION, project

PEERS = Path(__file__).resolve().parents[1] / "bench" / "peers"


@pytest.fixture
def pagecamera() -> ModuleType:
    """The bench's module, which is in no package."""
    spec = importlib.util.spec_from_file_location("pagecamera", PEERS / "pagecamera.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def camera() -> Camera:
    """Turned, raised, with its middle elsewhere and pixels that are not square."""
    seen = orbit((0.01, 0.02, 0.03), 1.2, 25, 12, 20, 550, 802)
    return replace(seen, fx=1.25 * seen.fx, cx=300.3, cy=350.7)


def test_pages_see_every_point_where_we_do(pagecamera: ModuleType, camera: Camera) -> None:
    points = np.random.default_rng(0).uniform(-0.15, 0.15, (50, 3))
    lens = pagecamera.lens_of(camera)
    pose, projection = (np.reshape(matrix, (4, 4)).T for matrix in (pagecamera.pose_of(camera), lens["projection"]))
    clip = np.c_[points, np.ones(50)] @ (projection @ np.linalg.inv(pose)).T
    seen = clip[:, :3] / clip[:, 3:]
    pixels = (seen[:, :2] * [1, -1] + 1) / 2 * [lens["width"], lens["height"]]
    splats = Gaussians(points, np.tile([1.0, 0, 0, 0], (50, 1)), np.ones((50, 3)), np.ones(50), np.ones((50, 3)))
    ours, _, depths = project(splats, camera)
    np.testing.assert_allclose(pixels, ours, atol=1e-9)
    np.testing.assert_allclose(clip[:, 3], depths, atol=1e-12)
    assert np.all(np.abs(seen[:, 2]) < 1)
    assert (seen[:, 2].argsort() == depths.argsort()).all()


def test_pose_is_rigid_and_at_the_pinhole(pagecamera: ModuleType, camera: Camera) -> None:
    """three.js takes it apart into a position and a quaternion, in which a mirror would be lost."""
    pose = np.reshape(pagecamera.pose_of(camera), (4, 4)).T
    np.testing.assert_allclose(pose[:3, 3], camera.center, atol=1e-12)
    np.testing.assert_allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1)


def test_pages_read_what_they_are_sent(pagecamera: ModuleType, camera: Camera) -> None:
    scripts = {file.name: file.read_text("utf-8") for file in PEERS.glob("page/*.js")}
    settings = pagecamera.settings_of((0.75, 0.75, 0.75))
    assert set(re.findall(r"\bsettings\.(?!js)(\w+)", "".join(scripts.values()))) == set(settings)
    assert settings["dilation"] == pytest.approx(float(DILATION))
    taken = re.search(r"setLens\(\{([^}]*)\}\)", scripts["stage.js"])
    assert taken is not None
    assert set(re.findall(r"\w+", taken[1])) == set(pagecamera.lens_of(camera))
