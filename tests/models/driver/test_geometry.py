"""Procrustes and the canonical face."""

import numpy as np
import pytest
from gemheads.models.driver.geometry import (
    FIELD_OF_VIEW_DEG,
    FaceGeometry,
    anchor,
    metric_pose,
    read_geometry,
)
from gemheads.models.driver.networks import FOLDER, GEOMETRY_FILE, read_checked
from gemheads.render.rotations import matrix_from_wxyz, rotvec_from_matrix, wxyz_from_rotvec


@pytest.fixture(scope="module")
def geometry() -> FaceGeometry:
    return read_geometry(read_checked(FOLDER, GEOMETRY_FILE))


def test_the_canonical_face_is_a_face(geometry: FaceGeometry) -> None:
    assert (geometry.weights > 0).sum() == 33
    width, height, depth = np.ptp(geometry.vertices, axis=0)
    assert 13 < width < 18
    assert 15 < height < 22
    assert 5 < depth < 14
    chin, forehead, nose = geometry.vertices[[152, 10, 1]]
    assert chin[1] < nose[1] < forehead[1]
    assert nose[2] > forehead[2]
    assert geometry.vertices[263, 0] > 0 > geometry.vertices[33, 0]  # the person's left is +x


def test_a_similarity_is_recovered_exactly() -> None:
    rng = np.random.default_rng(1)
    source, weights = rng.normal(size=(40, 3)), rng.uniform(0, 1, 40)
    rotation = matrix_from_wxyz(rng.normal(size=4))
    target = 2.5 * source @ rotation.T + [1.0, -2.0, 30.0]
    scale, found, translation = anchor(source, weights).similarity(target)
    assert scale == pytest.approx(2.5, abs=1e-12)
    np.testing.assert_allclose(found, rotation, atol=1e-12)
    np.testing.assert_allclose(translation, [1, -2, 30], atol=1e-11)


def test_points_without_weight_do_not_matter_and_a_mirror_image_is_no_rotation() -> None:
    rng = np.random.default_rng(2)
    source = rng.normal(size=(40, 3))
    target, weights = source.copy(), np.ones(40)
    target[7], weights[7] = 100, 0
    scale, rotation, translation = anchor(source, weights).similarity(target)
    assert scale == pytest.approx(1, abs=1e-12)
    np.testing.assert_allclose(rotation, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(translation, 0, atol=1e-12)
    _, mirrored, _ = anchor(source, np.ones(40)).similarity(source * [-1, 1, 1])
    assert np.linalg.det(mirrored) > 0


@pytest.mark.parametrize("turn_deg", [(0, 0, 0), (0, 25, 0), (-15, 0, 0), (5, -20, 12)])
def test_the_pose_of_a_projected_head_is_found(geometry: FaceGeometry, turn_deg: tuple[float, ...]) -> None:
    width, height, distance = 1280, 720, 90.0
    rotation = matrix_from_wxyz(wxyz_from_rotvec(np.radians(turn_deg)))
    points = geometry.vertices @ rotation.T + [4.0, -3.0, -distance]
    px_per_unit = height / (2 * np.tan(np.radians(FIELD_OF_VIEW_DEG) / 2))
    landmarks = np.stack(
        [
            width / 2 + px_per_unit * points[:, 0] / -points[:, 2],
            height / 2 - px_per_unit * points[:, 1] / -points[:, 2],
            px_per_unit * -points[:, 2] / distance,
        ],
        1,
    )
    pose, normalised = metric_pose(landmarks, width, height, geometry)
    scale = np.cbrt(np.linalg.det(pose[:3, :3]))
    error = rotvec_from_matrix(pose[:3, :3] / scale @ rotation.T)
    assert np.degrees(np.linalg.norm(error)) < 1
    np.testing.assert_allclose(pose[:3, 3], [4, -3, -distance], rtol=0.03)
    np.testing.assert_allclose(normalised, geometry.vertices, atol=0.3)


@pytest.mark.parametrize("damage", ["empty", "truncated", "text", "short"])
def test_other_bytes_are_refused(damage: str) -> None:
    content = read_checked(FOLDER, GEOMETRY_FILE)
    damaged = {"empty": b"", "truncated": content[:5000], "text": b"hello world" * 9, "short": content[:2]}[damage]
    with pytest.raises(ValueError, match=r"protobuf|face geometry"):
        read_geometry(damaged)
