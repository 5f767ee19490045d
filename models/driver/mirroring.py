"""A face is read as its mirror image is: the networks see both, and the mean of the two counts.

To the networks the two sides of a face are different things: they do not say the same of a picture and of its mirror
image. Who looks the same in a mirror is read the same so, and much of what is not the face, but where the networks
happened to look, is gone from the mean.
"""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats64
from .geometry import FaceGeometry
from .points import LEFT_IRIS, RIGHT_IRIS, SCORES

_RIM = (0, 3, 2, 1, 4)
"""An iris' centre and four rim points as those of the other eye's are named."""
_IRISES = [iris + place for iris in (LEFT_IRIS, RIGHT_IRIS) for place in _RIM]
_OTHER = {"Left": "Right", "Right": "Left"}
_OPPOSITE_SCORES = np.array(
    [SCORES.index(next((n.removesuffix(s) + o for s, o in _OTHER.items() if n.endswith(s)), n)) for n in SCORES]
)


def opposite_landmarks(geometry: FaceGeometry) -> NDArray[np.intp]:
    """[478] for each landmark the one on the other side of the face, for those in the middle themselves."""
    apart = geometry.vertices[:, None] * [-1, 1, 1] - geometry.vertices  # the canonical face is the same in a mirror
    return np.concatenate([(apart**2).sum(2).argmin(1), _IRISES])


def mirrored_landmarks(landmarks: Floats64, opposite: NDArray[np.intp], side: int) -> Floats64:
    """Landmarks [478, 3] of a picture ``side`` pixels wide as those of its mirror image."""
    swapped = landmarks[opposite]
    swapped[:, 0] = side - swapped[:, 0]
    return swapped


def mirrored_scores(scores: NDArray[np.float32]) -> NDArray[np.float32]:
    """Scores [52] of a face as those of its mirror image."""
    return scores[_OPPOSITE_SCORES]
