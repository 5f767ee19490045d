"""Where a picture was taken from, as a JSON file says it."""

import json
from pathlib import Path

import numpy as np

from ...models.brevity import brief
from ...models.wholefile import open_ordinary
from ...render.camera import Camera
from ..errors import InputError

_NUMBERS = ("fx", "fy", "cx", "cy")
_SIZE = ("width", "height")
_MAX_BYTES = 1 << 20


def load_camera(path: Path) -> Camera:
    """A camera of ``{"fx", "fy", "cx", "cy", "width", "height", "world_to_camera"}`` (docs/conventions.md).

    Raises InputError, which says what is wrong with the file.
    """
    try:
        with open_ordinary(path) as (file, size):
            if size > _MAX_BYTES:
                raise InputError(f"{path}: larger than {_MAX_BYTES >> 20} MB, as no camera is; see docs/commands.md")
            said = json.loads(file.read(_MAX_BYTES).decode("utf-8"))
        if not isinstance(said, dict):
            raise ValueError("no JSON object")
        missing = [key for key in (*_NUMBERS, *_SIZE, "world_to_camera") if key not in said]
        if missing:
            raise ValueError(f"lacks {', '.join(missing)}")
        matrix = np.asarray(said["world_to_camera"], np.float64)
        if matrix.shape != (4, 4) or not np.allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-3):
            raise ValueError("world_to_camera is no rigid 4x4 matrix")
        if not np.linalg.det(matrix[:3, :3]) > 0 or not np.allclose(matrix[3], [0, 0, 0, 1]):
            raise ValueError("world_to_camera mirrors, or its last row is not 0 0 0 1")
        width, height = (int(said[key]) for key in _SIZE)
        return Camera(*(float(said[key]) for key in _NUMBERS), width=width, height=height, world_to_camera=matrix)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error}); check the path") from error
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise InputError(f"{path}: not a camera ({brief(error)}); see `fit` in docs/commands.md") from error
