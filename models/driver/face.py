"""Following one face: detect it when lost, else look where it was; landmarks, scores, head pose, metric mesh."""

from dataclasses import dataclass
from math import cos, exp, sin
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64, Image
from .detector import Detection, FaceDetector, overlap
from .geometry import VERTICES, metric_pose, read_geometry
from .mirroring import mirrored_landmarks, mirrored_scores, opposite_landmarks
from .networks import FOLDER, GEOMETRY_FILE, LANDMARKS_FILE, SCORES_FILE, Network, read_checked
from .points import NET_INPUT
from .region import Region, eye_line_tilt, region_around

_CROP = 256
_LEAST_PRESENCE = 0.5
_LEAST_REGION_PX = 8.0
LEAST_SIDE, MOST_SIDE = 16, 16384
"""Of an image, in pixels."""
SAME_FACE = 0.2
"""Two boxes that overlap more than this (intersection over union) are the same face a moment later. On seven clips of
talking heads one face overlaps itself by .84 or more from frame to frame, by .44 or more after half a second; two
people side by side do not overlap at all."""
SETTLING = 2
"""Looks more at a face that was just detected: the detector's guess shifts what is read, and more than half of that is
gone after one look more, nearly all after two."""
MOVED = 0.004
"""A face whose region has moved on by more, as a share of its side or in radians, is looked at once more: where it was
a frame ago it is read askew, brows first (``tests/bench/lag.py``, by which people who talk move so in .15 to .7 of the
frames)."""
LOOKS_APART = 2
"""At a picture that does not follow the one before at once. A face is cut out where it was last; where only each fourth
frame is read it is not there any more, brows are read off first, and what is read agrees less than what people see."""
_NET_INPUT = np.array(NET_INPUT)
_LEAST_VARIANCE = 4.0
"""Of grey levels (0..255): what is flatter is no face, but the noise of a dark picture."""

Box = tuple[float, float, float, float]
"""Left, top, right, bottom in pixels of the image."""


@dataclass(frozen=True)
class FaceObservation:
    """What one image shows of one face."""

    landmarks_px: NDArray[np.float64]
    """[478, 3] x, y in pixels of the image (pixel centres at half integers); z in pixels, grows away. Landmarks and
    scores are means over the picture and its mirror image."""
    presence: float
    """How sure the landmark network is that it looks at a face, in (0.5, 1]."""
    scores: NDArray[np.float32]
    """[52] in the order of ``points.SCORES``, each in [0, 1]."""
    mixer: NDArray[np.float32]
    """[64] what the score network knows before it gives scores, of the picture as it is."""
    embedding: NDArray[np.float32]
    """[512] what the landmark network knows before it gives landmarks, of the picture as it is."""
    head_pose: NDArray[np.float64]
    """[4, 4] canonical face to camera, scale included: cm, y up, camera at the origin looking along -z."""
    metric_mesh: NDArray[np.float64]
    """[468, 3] landmarks with the head pose taken off: cm, x to the person's left, y up, z out of the face."""
    metric_irises: NDArray[np.float64]
    """[10, 3] the same of the irises: centre and four rim points of the right eye, then of the left."""
    image_size: tuple[int, int]
    """Width and height in pixels."""
    sharpness: float
    """Mean squared Laplacian of the face's crop over the variance of its grey levels, so that it does not depend on how
    bright or soft the light is: a blurred face is near 0."""
    faces: int | None
    """How many faces the detector saw; None when it did not have to run."""

    @property
    def box_px(self) -> Box:
        """What the landmarks fill."""
        x, y = self.landmarks_px[:, 0], self.landmarks_px[:, 1]
        return float(x.min()), float(y.min()), float(x.max()), float(y.max())


class FaceTracker:
    """Follows one face from image to image, on one thread. Not for two threads at once."""

    def __init__(self, networks: Path | None = None, moved: float = MOVED) -> None:
        """Opens the networks of a folder (default: the shipped ones). A face that moves by more than ``moved`` from an
        image to the next is looked at twice. Raises NetworkError when a network is another."""
        folder = networks or FOLDER
        self._detect = FaceDetector(folder)
        self._landmarks = Network(folder, LANDMARKS_FILE, ("landmarks", "presence_logit", "embedding"))
        self._scores = Network(folder, SCORES_FILE, ("blendshapes", "mixer_embedding"))
        self._geometry = read_geometry(read_checked(folder, GEOMETRY_FILE))
        self._opposite = opposite_landmarks(self._geometry)
        self._moved = moved
        self._region: Region | None = None
        self._last_box: Box | None = None
        self._size: tuple[int, int] | None = None

    @property
    def providers(self) -> tuple[str, ...]:
        """What the landmark network runs on, the first choice first: to be compared with ``networks.PROVIDERS``."""
        return self._landmarks.providers

    def track(self, rgb: NDArray[np.uint8], locked: Box | None = None) -> FaceObservation | None:
        """The followed face in an image [H, W, 3] of RGB bytes; None when there is none.

        A face that is lost is looked for in the same image: first near where it was, else the surest anywhere.

        Args:
            rgb: the image.
            locked: where the only face that counts was a moment ago, in pixels of the image before, which may have been
                larger or smaller; a face that does not overlap this is somebody else, and is passed by. None: anybody
                counts.

        Raises:
            ValueError: when ``rgb`` is not such an image, or has a side outside 16..16384 pixels.
        """
        rgb = _checked(rgb)
        locked = self._resized(rgb, locked)
        found = self._followed(rgb, self._region) if self._region else None
        if found is None or _is_another(found, locked):
            found = self._find(rgb, locked)
        if found is None:
            self._region = None
            return None
        self._region = region_around(found.landmarks_px)
        self._last_box = found.box_px
        return found

    def detect(self, rgb: NDArray[np.uint8]) -> list[Detection]:
        """All faces of an image, the surest first, without following any. Raises ValueError like ``track``."""
        return self._detect(_checked(rgb))

    def lock(self, face: Detection) -> None:
        """From the next image on, follow this face of the last one."""
        self._region, self._last_box = face.region, face.box_px

    def reset(self) -> None:
        """Forget the face: the next image is searched as if it were the first."""
        self._region = self._last_box = self._size = None

    def _resized(self, rgb: NDArray[np.uint8], locked: Box | None) -> Box | None:
        """``locked`` in pixels of this image, as the face that is followed: meetings change their size as they go."""
        before, self._size = self._size, (rgb.shape[1], rgb.shape[0])
        if before is None or before == self._size:
            return locked
        across, down = (now / then for now, then in zip(self._size, before, strict=True))
        if self._region is not None:
            self._region = self._region.scaled(across, down)
        if self._last_box is not None:
            self._last_box = _scaled(self._last_box, across, down)
        return None if locked is None else _scaled(locked, across, down)

    def _find(self, rgb: NDArray[np.uint8], locked: Box | None) -> FaceObservation | None:
        """Run the detector and look at what it found: the face that was followed before, then the others."""
        detections = self._detect(rgb)
        last = locked or self._last_box
        if last is not None:
            detections.sort(key=lambda face: overlap(face.box_px, last) < SAME_FACE)
        for face in detections:
            found = self._look(rgb, face.region, len(detections))
            if found is not None and not _is_another(found, locked):
                return self._settled(rgb, found)
        return None

    def _followed(self, rgb: NDArray[np.uint8], region: Region) -> FaceObservation | None:
        """The face that was in ``region`` a moment ago; looked at once more, if it has moved, where it is now."""
        found = self._look(rgb, region, None)
        if found is None or region.apart(now := region_around(found.landmarks_px)) <= self._moved:
            return found
        return self._look(rgb, now, None) or found

    def _settled(self, rgb: NDArray[np.uint8], found: FaceObservation) -> FaceObservation:
        """What is seen around the landmarks of what was seen around the detector's guess, as in all later pictures."""
        for _ in range(SETTLING):
            found = self._look(rgb, region_around(found.landmarks_px), found.faces) or found
        return found

    def _look(self, rgb: NDArray[np.uint8], region: Region, faces: int | None) -> FaceObservation | None:
        """Landmarks inside a region and all that follows from them; None when there is no face in it."""
        if not region.size >= _LEAST_REGION_PX:
            return None
        crop = region.crop(rgb, _CROP)
        plain, presence, embedding = self._landmarks_in(crop)
        if presence < _LEAST_PRESENCE:
            return None
        in_mirror, _, _ = self._landmarks_in(np.ascontiguousarray(crop[:, ::-1]))
        points = (plain + mirrored_landmarks(in_mirror, self._opposite, _CROP)) / 2
        if not np.isfinite(points).all():
            return None
        to_image = region.to_image(_CROP)
        landmarks = np.empty_like(points)
        landmarks[:, :2] = points[:, :2] @ to_image[:, :2].T + to_image[:, 2]
        landmarks[:, 2] = points[:, 2] * (region.size / _CROP)
        scores, mixer = self._scores_of(points)
        scores_in_mirror, _ = self._scores_of(mirrored_landmarks(points, self._opposite, _CROP))
        height, width = rgb.shape[:2]
        pose, metric = metric_pose(landmarks, width, height, self._geometry)
        return FaceObservation(
            landmarks_px=landmarks,
            presence=presence,
            scores=((scores + mirrored_scores(scores_in_mirror)) / 2).astype(np.float32, copy=False),
            mixer=mixer,
            embedding=embedding,
            head_pose=pose,
            metric_mesh=metric[:VERTICES],
            metric_irises=metric[VERTICES:],
            image_size=(width, height),
            sharpness=_sharpness(crop),
            faces=faces,
        )

    def _landmarks_in(self, crop: Image) -> tuple[Floats64, float, NDArray[np.float32]]:
        """Of a crop: landmarks [478, 3] in its pixels, presence, embedding [512]."""
        points, logit, embedding = self._landmarks((crop.astype(np.float32) * np.float32(1 / 255))[None])
        presence = 1 / (1 + exp(-min(max(logit.item(), -80.0), 80.0)))
        return points.reshape(-1, 3).astype(np.float64), presence, embedding.reshape(-1)

    def _scores_of(self, points: Floats64) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Of landmarks [478, 3] in pixels of the crop: scores [52], mixer [64]."""
        scores, mixer = self._scores(_upright(points)[None])
        return scores.reshape(-1), mixer.reshape(-1)


def looked(tracker: FaceTracker, rgb: NDArray[np.uint8], looks: int) -> FaceObservation | None:
    """What a tracker sees after so many looks at a picture, each cut out around what the one before saw; None when
    there is no face. Raises ValueError like ``track``."""
    face = tracker.track(rgb)
    for _ in range(looks - 1):
        face = None if face is None else tracker.track(rgb)
    return face


def _scaled(box: Box, across: float, down: float) -> Box:
    left, top, right, bottom = box
    return left * across, top * down, right * across, bottom * down


def _is_another(face: FaceObservation, locked: Box | None) -> bool:
    return locked is not None and overlap(face.box_px, locked) < SAME_FACE


def _upright(points: NDArray[np.float64]) -> NDArray[np.float32]:
    """[146, 2] the score network's landmarks, the eye line level: its scores move with roll 2.4 times less that way."""
    tilt = eye_line_tilt(points)
    turn = np.array([[cos(tilt), -sin(tilt)], [sin(tilt), cos(tilt)]])
    centre = _CROP / 2
    return ((points[_NET_INPUT, :2] - centre) @ turn + centre).astype(np.float32)


def _sharpness(crop: NDArray[np.uint8]) -> float:
    """Of what is left when the grain is smoothed away: that of a dark picture is no detail."""
    middle = crop[_CROP // 6 : -_CROP // 6, _CROP // 6 : -_CROP // 6]  # the face without its surroundings
    grey = cv2.cvtColor(middle, cv2.COLOR_RGB2GRAY).astype(np.float32)
    smooth = cv2.GaussianBlur(cv2.resize(grey, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA), (0, 0), 1.0)
    detail = cv2.norm(cv2.Laplacian(smooth, cv2.CV_32F), cv2.NORM_L2SQR) / smooth.size
    return float(detail) / max(float(smooth.var()), _LEAST_VARIANCE)


def _checked(rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The image as contiguous memory, after making sure that it is one."""
    if not isinstance(rgb, np.ndarray):
        raise ValueError(f"an image must be a NumPy array, got {type(rgb).__name__}")
    if rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
        raise ValueError(f"an image must be [height, width, 3] RGB of uint8, got {list(rgb.shape)} of {rgb.dtype}")
    if not all(LEAST_SIDE <= side <= MOST_SIDE for side in rgb.shape[:2]):
        size = f"{rgb.shape[1]}x{rgb.shape[0]}"
        raise ValueError(f"an image must be {LEAST_SIDE} to {MOST_SIDE} pixels a side, got {size}")
    return np.ascontiguousarray(rgb)
