"""Faces without faces: pictures whose bands of grey say what somebody does, and a tracker that reads them."""

import numpy as np
from gemheads.models.driver.detector import Detection
from gemheads.models.driver.face import Box, FaceObservation
from gemheads.models.driver.geometry import VERTICES, read_geometry
from gemheads.models.driver.networks import FOLDER, GEOMETRY_FILE, read_checked
from gemheads.models.driver.points import SCORES
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec
from numpy.typing import NDArray

SIDE = 96
MOST_YAW = np.radians(40.0)
_MESH = read_geometry(read_checked(FOLDER, GEOMETRY_FILE)).vertices[:VERTICES].copy()
_IRISES = np.repeat([_MESH[[33, 133]].mean(0), _MESH[[362, 263]].mean(0)], 5, axis=0)


def painted(jaw: float = 0.0, smile: float = 0.0, yaw: float = 0.0, blink: float = 0.0) -> NDArray[np.uint8]:
    """[SIDE, SIDE, 3] of scores in [0, 1] and a turn in radians."""
    bands = np.array([jaw, smile, 0.5 + yaw / (2 * MOST_YAW), blink])
    rows = np.repeat(np.round(15 + 225 * np.clip(bands, 0, 1)), SIDE // 4)
    return np.broadcast_to(rows[:, None, None], (SIDE, SIDE, 3)).astype(np.uint8)


class PixelTracker:
    """Reads what ``painted`` paints, and something off any other picture; a black picture shows nobody."""

    def track(self, rgb: NDArray[np.uint8], locked: Box | None = None) -> FaceObservation | None:
        """A face as large as the picture."""
        if rgb.max() < 10:
            return None
        height, width = rgb.shape[:2]
        bands = np.array([band.mean() for band in np.array_split(rgb.astype(float), 4)])
        jaw, smile, turn, blink = np.clip((bands - 15) / 225, 0, 1)
        return _seen(jaw, smile, (turn - 0.5) * 2 * MOST_YAW, blink, (width, height))

    def detect(self, rgb: NDArray[np.uint8]) -> list[Detection]:
        """Nobody else."""
        return []

    def reset(self) -> None:
        """It remembers nothing."""


def _seen(jaw: float, smile: float, yaw: float, blink: float, size: tuple[int, int]) -> FaceObservation:
    scores = np.zeros(len(SCORES), np.float32)
    told = {
        "jawOpen": jaw,
        "mouthSmileLeft": smile,
        "mouthSmileRight": smile,
        "eyeBlinkLeft": blink,
        "eyeBlinkRight": blink,
    }
    for name, value in told.items():
        scores[SCORES.index(name)] = value
    pose = np.eye(4)
    pose[:3, :3] = matrix_from_wxyz(wxyz_from_rotvec(np.array([0.0, yaw, 0.0])))
    points = np.concatenate([_MESH, _IRISES])
    points[14, 1] -= 2 * jaw
    landmarks = np.stack([points[:, 0], -points[:, 1], -points[:, 2]], 1) * (min(size) / 30)
    landmarks[:, :2] += np.array(size) / 2
    embedding = np.zeros(512, np.float32)
    embedding[:4] = jaw, smile, blink, 0.1
    return FaceObservation(
        landmarks_px=landmarks,
        presence=1.0,
        scores=scores,
        mixer=np.zeros(64, np.float32),
        embedding=embedding,
        head_pose=pose,
        metric_mesh=_MESH,
        metric_irises=_IRISES,
        image_size=size,
        sharpness=0.01,
        faces=None,
    )
