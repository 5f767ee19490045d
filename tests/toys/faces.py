"""What a tracker sees of somebody who has a jaw and a head that turns, and nothing else."""

from collections.abc import Sequence

import numpy as np
from gemheads.models.driver.face import FaceObservation
from gemheads.models.driver.points import SCORES
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec

_RNG = np.random.default_rng(3)
_MESH, _IRISES = _RNG.normal(size=(468, 3)), 0.2 * _RNG.normal(size=(10, 3))
_MESH[14] = _MESH[13]  # lips together: at rest


def face(
    jaw: float = 0.0, turn: Sequence[float] = (0, 0, 0), at: tuple[float, float] = (100, 100), lips_cm: float = 0.0
) -> FaceObservation:
    """What a tracker would see of a face 80 pixels wide; ``lips_cm``: how far its lips are apart."""
    mesh = _MESH.copy()
    mesh[14, 1] -= lips_cm
    pose = np.eye(4)
    pose[:3, :3] = matrix_from_wxyz(wxyz_from_rotvec(np.asarray(turn, float)))
    scores = np.zeros(len(SCORES), np.float32)
    scores[SCORES.index("jawOpen")] = jaw
    landmarks = np.tile([*at, 0.0], (478, 1))
    landmarks[1, :2] += 80.0
    return FaceObservation(
        landmarks_px=landmarks,
        presence=1.0,
        scores=scores,
        mixer=np.zeros(64, np.float32),
        embedding=np.zeros(512, np.float32),
        head_pose=pose,
        metric_mesh=mesh,
        metric_irises=_IRISES,
        image_size=(640, 480),
        sharpness=0.01,
        faces=None,
    )
