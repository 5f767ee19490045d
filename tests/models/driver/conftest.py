"""A real face to track: the shipped demo clip, or one of the clips beside the checkout."""

from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest
from faces import face
from gemheads.models.driver.face import FaceObservation, FaceTracker
from gemheads.models.driver.geometry import VERTICES, read_geometry
from gemheads.models.driver.networks import FOLDER, GEOMETRY_FILE, read_checked
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[3]
CLIPS = (
    ROOT.parent / "shared" / "data" / "drivers" / "single_face.mp4",
    ROOT / "assets" / "demo" / "driver.mp4",
)


@pytest.fixture(scope="session")
def frames() -> list[NDArray[np.uint8]]:
    """The first 48 pictures of a clip of one face."""
    clip = next((path for path in CLIPS if path.exists()), None)
    if clip is None:
        pytest.skip(f"no face to look at: neither {CLIPS[0]} nor {CLIPS[1]} is there")
    with av.open(clip) as video:
        return [frame.to_ndarray(format="rgb24") for frame, _ in zip(video.decode(video=0), range(48), strict=False)]


@pytest.fixture
def tracker() -> FaceTracker:
    return FaceTracker()


@pytest.fixture(scope="session")
def canonical() -> NDArray[np.float64]:
    """[468, 3] the canonical face in cm."""
    return read_geometry(read_checked(FOLDER, GEOMETRY_FILE)).vertices


@pytest.fixture
def still_face(canonical: NDArray[np.float64]) -> FaceObservation:
    """An observation of the canonical face, straight ahead at 40 cm, without expression."""
    pose = np.eye(4)
    pose[2, 3] = -40
    mesh = canonical[:VERTICES].copy()
    mesh[[13, 14], 1] = mesh[[13, 14], 1].mean()  # the canonical face holds its lips apart
    corners = mesh[[33, 133, 362, 263]]
    irises = np.repeat([corners[:2].mean(0), corners[2:].mean(0)], 5, axis=0)
    scores = np.full(52, 0.05, np.float32)
    return replace(face(), scores=scores, head_pose=pose, metric_mesh=mesh, metric_irises=irises)
