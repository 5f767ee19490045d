"""Pictures as files."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ...models.wholefile import write_whole
from ..errors import cannot_write


def write_png(image: NDArray[np.uint8], out: Path) -> None:
    """Write sRGB [H, W, 3] as a PNG, making the folder where it is missing. Raises OutputError."""
    png = cv2.imencode(".png", np.ascontiguousarray(image[..., ::-1]))[1]
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        write_whole(out, [png.tobytes()])
    except OSError as error:
        raise cannot_write(out, error) from error
