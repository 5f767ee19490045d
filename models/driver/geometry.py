"""Head pose and metric mesh: the canonical face laid on the landmarks by weighted Procrustes.

The method is that of MediaPipe's face geometry module: landmarks are unprojected through an assumed camera, at the
depth where the canonical face has its own size, and the similarity that fits the canonical face is the head pose.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .protobuf import fields, message

Floats = NDArray[np.float64]

VERTICES = 468
FIELD_OF_VIEW_DEG = 20.0
"""Vertical field of view of the camera that is assumed, for drivers and renders alike.

MediaPipe assumes 63. The landmark network's depth is nearly that of a parallel projection, so a narrow camera fits it
better: on six clips of people, distances between points of bone vary 4 to 33 % less than at 63 (best near 20), and on
rendered heads turned by known angles the pitch that is found grows from .76 to .88 of the true one, while brows move
half as much with the pose.
"""
_NEAR_CM = 1.0
_TOWARDS_VIEWER = np.array([1.0, 1.0, -1.0])
"""Landmark depth grows away from the camera, the metric frame looks along -z."""


@dataclass(frozen=True)
class FaceGeometry:
    """The canonical face: cm, x to the person's left, y up, z out of the face."""

    vertices: Floats
    """[468, 3] cm."""
    weights: Floats
    """[468] >= 0, zero for all but the 33 points that Procrustes looks at."""
    basis: NDArray[np.intp]
    """[33] which those are."""


def read_geometry(content: bytes) -> FaceGeometry:
    """Reads MediaPipe's ``geometry_pipeline_metadata``. Raises ValueError when it is anything else."""
    vertex_buffer: list[NDArray[np.float32]] = []
    weights = np.zeros(VERTICES)
    for number, value in fields(content):
        if number == 1:  # canonical mesh: vertex type, primitive type, vertex buffer (x y z u v), index buffer
            vertex_buffer += [np.frombuffer(message(v), "<f4") for n, v in fields(message(value)) if n == 3]
        elif number == 2:  # one landmark of the Procrustes basis: index (absent when 0), weight
            entry = dict(fields(message(value)))
            index = entry.get(1, 0)
            if not isinstance(index, int) or index >= VERTICES:
                raise ValueError(f"face geometry: landmark {index!r} of the Procrustes basis does not exist")
            weights[index] = np.frombuffer(message(entry[2]), "<f4")[0]
    flat = np.concatenate(vertex_buffer) if vertex_buffer else np.zeros(0, np.float32)
    if flat.size != VERTICES * 5 or not np.isfinite(flat).all() or not (weights > 0).any():
        raise ValueError(f"face geometry: {flat.size} vertex values instead of {VERTICES * 5}, or no basis")
    return FaceGeometry(flat.reshape(VERTICES, 5)[:, :3].astype(np.float64), weights, np.flatnonzero(weights))


def weighted_similarity(source: Floats, target: Floats, weights: Floats) -> Floats:
    """The similarity [4, 4] (rotation, one scale, translation) from ``source`` [n, 3] to ``target`` [n, 3].

    It is nearest in the sense of weighted least squares: Akca, "Generalized Procrustes analysis" (2003), section 2.2.
    """
    share = (weights / weights.sum())[:, None]
    source_centre, target_centre = (source * share).sum(0), (target * share).sum(0)
    centred = source - source_centre
    u, _, vt = np.linalg.svd(((target - target_centre) * share).T @ centred)
    rotation = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
    scale = ((centred @ rotation.T) * (target - target_centre) * share).sum() / (centred**2 * share).sum()
    similarity = np.eye(4)
    similarity[:3, :3] = scale * rotation
    similarity[:3, 3] = target_centre - scale * rotation @ source_centre
    return similarity


def metric_pose(landmarks_px: Floats, width: int, height: int, geometry: FaceGeometry) -> tuple[Floats, Floats]:
    """Head pose and pose-normalised landmarks.

    Args:
        landmarks_px: [n >= 468, 3] x, y, z in pixels of the image (z: 0 about the head's middle, grows away); the
            first 468 are the mesh.
        width, height: size of the image in pixels.

    Returns:
        head_pose [4, 4], canonical face to camera (cm, y up, camera at the origin looking along -z), scale included;
        and the landmarks [n, 3] in the canonical frame (cm).
    """
    view_height = 2 * _NEAR_CM * np.tan(np.radians(FIELD_OF_VIEW_DEG) / 2)
    cm_per_px = view_height / height
    screen = landmarks_px * cm_per_px
    screen[:, 0] -= width * cm_per_px / 2
    screen[:, 1] = view_height / 2 - screen[:, 1]
    middle_depth = screen[:VERTICES, 2].mean()

    def unprojected(scale: float) -> Floats:
        points = screen.copy()
        points[:, 2] = (points[:, 2] - middle_depth + _NEAR_CM) / scale
        points[:, :2] *= points[:, 2:] / _NEAR_CM
        return points * _TOWARDS_VIEWER

    def fitted(points: Floats) -> Floats:
        basis = geometry.basis
        return weighted_similarity(geometry.vertices[basis], points[basis], geometry.weights[basis])

    first = np.linalg.norm(fitted(screen * _TOWARDS_VIEWER)[:3, 0])
    second = np.linalg.norm(fitted(unprojected(float(first)))[:3, 0])
    points = unprojected(float(first * second))
    pose = fitted(points)
    normalised = np.linalg.solve(pose, np.c_[points, np.ones(len(points))].T).T[:, :3]
    return pose, normalised
