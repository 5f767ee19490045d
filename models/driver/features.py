"""One observation to one feature vector f; what drives is r = f - f of the neutral.

Blocks: the metric mesh about mouth, eyes, brows and jaw; gaze; distances on the mesh; the live scores; the mixer.
The 512 values of the landmark network's embedding are left out: under a shift of the crop they change by .67 of what
expressions change, the other blocks by .17.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from . import points
from .face import FaceObservation
from .gaze import GAZE, eye_gaze
from .measures import MEASURES, measure
from .sides import believed_sides

FEATURE_VERSION = 1
"""Grows with every change of what a feature means: a regressor is only valid with the version it was trained on. How
surely a feature is read, of mirror images or by ``sides``, is not what it means."""

_WEIGHTS = (
    (points.LIPS, 1.0),
    (points.RIGHT_EYE + points.LEFT_EYE, 1.5),
    (points.RIGHT_BROW + points.LEFT_BROW, 1.0),
    (points.JAW, 0.7),
    (points.NOSE + points.CHEEKS, 0.5),
)
_MESH_POINTS = np.array([point for group, _ in _WEIGHTS for point in group])
_MESH_WEIGHTS = np.concatenate([np.full(len(group), weight) for group, weight in _WEIGHTS])[:, None]

SCORE_NAMES = tuple(name for name in points.SCORES if name not in points.DEAD_SCORES)
"""Order of the block of scores."""
_LIVE = np.array([points.SCORES.index(name) for name in SCORE_NAMES])


def _laid_out(**sizes: int) -> dict[str, slice]:
    ends = np.cumsum(list(sizes.values())).tolist()
    return {name: slice(end - size, end) for (name, size), end in zip(sizes.items(), ends, strict=True)}


BLOCKS = _laid_out(
    mesh=3 * len(_MESH_POINTS), gaze=len(GAZE), measures=len(MEASURES), scores=len(SCORE_NAMES), mixer=64
)
"""Block -> its part of the vector. mesh: weighted x, y, z in cm, point by point; gaze: radians, order of ``gaze.GAZE``;
measures: cm, order of ``measures.MEASURES``; scores: [0, 1], order of SCORE_NAMES, sides as ``sides`` has them;
mixer: the network's own units."""
DIMENSION = BLOCKS["mixer"].stop
"""D, the length of a feature vector."""
SCORES = BLOCKS["scores"]
"""Where the scores are, in the order of SCORE_NAMES."""


def feature_vector(face: FaceObservation) -> NDArray[np.float32]:
    """f [D]: the blocks of BLOCKS one behind the other."""
    features = np.empty(DIMENSION, np.float32)
    features[BLOCKS["mesh"]] = (face.metric_mesh[_MESH_POINTS] * _MESH_WEIGHTS).ravel()
    features[BLOCKS["gaze"]] = eye_gaze(face.metric_mesh, face.metric_irises)
    features[BLOCKS["measures"]] = measure(face.metric_mesh)
    features[BLOCKS["scores"]] = believed_sides(face.scores, head_rotation(face)[1])[_LIVE]
    features[BLOCKS["mixer"]] = face.mixer
    return features


def score(features: NDArray[np.floating], name: str) -> NDArray[np.floating]:
    """One live score (or relative score) [...] by its name out of feature vectors [..., D]. KeyError if dead."""
    if name not in SCORE_NAMES:
        raise KeyError(f"no live score is called {name!r}")
    return features[..., SCORES.start + SCORE_NAMES.index(name)]


def head_rotation(face: FaceObservation) -> NDArray[np.float64]:
    """[3] axis and angle, radians, of the head against the camera: x pitch (> 0 looks down), y yaw (> 0 turns to the
    person's left), z roll (> 0 tilts to the person's right)."""
    return _rotvec(face.head_pose[:3, :3])  # its scale does not matter


def relative_rotation(rotation: NDArray[np.float64], neutral: NDArray[np.float64]) -> NDArray[np.float64]:
    """[3] axis and angle of the turn that takes a person's head from ``neutral`` [3] to ``rotation`` [3], about the
    head's own axes: an avatar's is turned about its own, and nobody levels a camera. About the axes of one that lies on
    its side, who shakes the head would nod."""
    return _rotvec(_matrix(neutral).T @ _matrix(rotation))


def rotation_in_camera(rotation: NDArray[np.float64], neutral: NDArray[np.float64]) -> NDArray[np.float64]:
    """[3] the same turn about the axes of the camera, for pictures that are drawn: before a camera that is known these
    are the better ones, since a head's own are read off its face, on some heads 6 degrees too high or too low."""
    return _rotvec(_matrix(rotation) @ _matrix(neutral).T)


def _matrix(rotvec: NDArray[np.floating]) -> NDArray[np.float64]:
    return np.asarray(cv2.Rodrigues(rotvec)[0], np.float64)


def _rotvec(matrix: NDArray[np.floating]) -> NDArray[np.float64]:
    """Axis and angle of the rotation nearest to ``matrix``: for a single one OpenCV takes a twentieth of the time that
    ``render.rotations`` takes."""
    if not np.isfinite(matrix).all():
        return np.full(3, np.nan)  # of these OpenCV makes no rotation at all, which would look like a head at rest
    return np.asarray(cv2.Rodrigues(matrix)[0], np.float64).reshape(3)
