"""Small pictures of faces, packed: every frame of a clip is kept, since only the end knows which are shown."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Image

SIDE = 192
"""Of a picture, pixels."""
QUALITY = 92
"""Of JPEG."""
_AROUND = (191, 191, 191)
_MARGIN = 1.7
"""Of a face's picture, in sides of the face."""


@dataclass(frozen=True)
class Album:
    """F pictures [SIDE, SIDE, 3]."""

    packed: NDArray[np.uint8]
    """[bytes] JPEGs, one behind the other."""
    ends: NDArray[np.int64]
    """[F] where each ends."""

    def __len__(self) -> int:
        return len(self.ends)

    def __getitem__(self, index: int) -> Image:
        """sRGB [SIDE, SIDE, 3]. Raises ValueError where the bytes are not a picture of this size."""
        begin = int(self.ends[index - 1]) if index else 0
        picture = cv2.imdecode(self.packed[begin : int(self.ends[index])], cv2.IMREAD_COLOR)
        if picture is None or picture.shape != (SIDE, SIDE, 3):
            raise ValueError(f"picture {index} of an album is damaged")
        return np.ascontiguousarray(picture[..., ::-1], np.uint8)


def packed(picture: Image) -> NDArray[np.uint8]:
    """[bytes] of one picture [SIDE, SIDE, 3]."""
    coded = cv2.imencode(".jpg", np.ascontiguousarray(picture[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
    return np.asarray(coded, np.uint8).reshape(-1)


def bound(pictures: Sequence[NDArray[np.uint8]]) -> Album:
    """Packed pictures as an album."""
    ends = np.cumsum([len(picture) for picture in pictures], dtype=np.int64)
    return Album(np.concatenate([np.zeros(0, np.uint8), *pictures]), ends)


def face_square(picture: Image, box_px: tuple[float, float, float, float]) -> Image:
    """A face (left, top, right, bottom) with its surroundings, upright in the image, [SIDE, SIDE, 3]."""
    left, top, right, bottom = box_px
    scale = SIDE / (_MARGIN * max(right - left, bottom - top))
    matrix = np.array(
        [
            [scale, 0, SIDE / 2 - scale * (left + right) / 2],
            [0, scale, SIDE / 2 - scale * (top + bottom) / 2],
        ]
    )
    square = cv2.warpAffine(picture, matrix, (SIDE, SIDE), flags=cv2.INTER_AREA, borderValue=_AROUND)
    return np.asarray(square, np.uint8)


def small(picture: Image) -> Image:
    """A square picture as [SIDE, SIDE, 3]."""
    return np.asarray(cv2.resize(picture, (SIDE, SIDE), interpolation=cv2.INTER_AREA), np.uint8)
