"""Finding faces: the short-range detector of MediaPipe on the whole image."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from .networks import DETECTOR_FILE, Network
from .region import Region

LEAST_FACE = 1 / 8
"""Of the image's longer side: so high a face is seen surely, chin to forehead; one of a tenth now and then."""
_SIDE = 128
_GRIDS = ((16, 2), (8, 6))
"""(cells a side, anchors a cell) of the detector's two feature maps."""
_REGION_SCALE = 1.5
"""The landmark network sees this many detected boxes."""


@dataclass(frozen=True)
class Detection:
    """One face that the detector sees."""

    box_px: tuple[float, float, float, float]
    """Left, top, right, bottom in pixels of the image."""
    score: float
    """In (0, 1)."""
    region: Region
    """The turned square that the landmark network is to look at."""


class FaceDetector:
    """About 1.5 ms an image; sees faces that are LEAST_FACE high or more."""

    def __init__(self, networks: Path) -> None:
        """Raises NetworkError when the network in the folder ``networks`` cannot be opened."""
        self._network = Network(networks, DETECTOR_FILE, ("regressors", "classificators"))
        self._anchors = _anchors()

    def __call__(self, rgb: NDArray[np.uint8], least_score: float = 0.5) -> list[Detection]:
        """The faces of an image [H, W, 3], the surest first."""
        square, scale, left, top = _letterboxed(rgb)
        offsets, logits = self._network((square.astype(np.float32) * (2 / 255) - 1)[None])
        scores = 1 / (1 + np.exp(-np.clip(logits[0, :, 0], -80, 80)))
        keep = np.flatnonzero(scores > least_score)
        points = offsets[0, keep].reshape(-1, 8, 2).astype(np.float64) / _SIDE
        points[:, 0] += self._anchors[keep]
        points[:, 2:] += self._anchors[keep][:, None]
        half = points[:, 1] / 2
        corners = np.concatenate([(points[:, 0] - half)[:, None], (points[:, 0] + half)[:, None], points[:, 2:]], 1)
        corners = (corners * _SIDE - [left, top]) / scale
        return _merged(corners, scores[keep].astype(np.float64))


def overlap(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    """Intersection over union of two boxes (left, top, right, bottom)."""
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    shared = width * height
    return shared / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - shared)


def _anchors() -> NDArray[np.float64]:
    """[896, 2] centres of the detector's anchors in units of the square."""
    centres: list[NDArray[np.float64]] = []
    for cells, count in _GRIDS:
        y, x = np.mgrid[:cells, :cells]
        centres.append(np.repeat(np.stack([x.ravel() + 0.5, y.ravel() + 0.5], 1) / cells, count, axis=0))
    return np.concatenate(centres)


def _letterboxed(rgb: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], float, int, int]:
    """The image in a black square, its scale, and the pixels of black at the left and the top."""
    height, width = rgb.shape[:2]
    scale = _SIDE / max(height, width)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    shrunk = cv2.resize(rgb, size, interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)
    left, top = (_SIDE - size[0]) // 2, (_SIDE - size[1]) // 2
    square = np.zeros((_SIDE, _SIDE, 3), np.uint8)
    square[top : top + size[1], left : left + size[0]] = shrunk
    return square, scale, left, top


def _merged(corners: NDArray[np.float64], scores: NDArray[np.float64]) -> list[Detection]:
    """Weighted non-maximum suppression: overlapping candidates [n, 8, 2] (two box corners, six points) become one."""
    found: list[Detection] = []
    left = list(np.argsort(-scores, kind="stable"))
    while left:
        best = tuple(corners[left[0], :2].ravel())
        group = [i for i in left if overlap(best, tuple(corners[i, :2].ravel())) > 0.3]
        group = group or left[:1]  # a box without area overlaps nothing, not even itself
        left = [i for i in left if i not in group]
        points = (corners[group] * scores[group, None, None]).sum(0) / scores[group].sum()
        (x0, y0), (x1, y1), right_eye, left_eye = points[:4]
        size = max(x1 - x0, y1 - y0) * _REGION_SCALE
        if size > 1:
            tilt = float(np.arctan2(left_eye[1] - right_eye[1], left_eye[0] - right_eye[0]))
            region = Region(float(x0 + x1) / 2, float(y0 + y1) / 2, float(size), tilt)
            box = float(x0), float(y0), float(x1), float(y1)
            found.append(Detection(box, float(scores[group].max()), region))
    return found
