"""Writing a capture: pictures as they come, the lists of them last, so that what is unfinished is not opened."""

import io
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...render.camera import Camera
from ..wholefile import write_whole
from .layout import (
    IMAGES,
    MASKS,
    MESHES,
    SPLITS,
    TEMPLATE,
    TRUTH,
    UNITS,
    Shot,
    Template,
    mesh_name,
    picture_name,
    transforms_name,
)
from .pictures import png_bytes
from .transforms import frame_of


@dataclass(frozen=True)
class CaptureWriter:
    """A capture that is being written. Every file appears whole or not at all; all methods raise OSError."""

    folder: Path

    def begin(self, template: Template) -> None:
        """Make the folders and write the template."""
        for name in (IMAGES, MASKS, MESHES):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        arrays = {name: value for name, value in vars(template).items() if name != "part_names"}
        _write_arrays(self.folder / TEMPLATE, part_names=np.array(template.part_names), **arrays)

    def shot(self, timestep: int, camera_index: int, camera: Camera) -> Shot:
        """The shot of this place in the capture, drawn or not."""
        name = picture_name(timestep, camera_index)
        return Shot(self.folder / IMAGES / name, self.folder / MASKS / name, camera, camera_index, timestep)

    def is_drawn(self, shot: Shot) -> bool:
        """Whether the picture and its mask are there."""
        return shot.picture.is_file() and (shot.mask is None or shot.mask.is_file())

    def write_picture(self, shot: Shot, rgb: NDArray[np.uint8], alpha: NDArray[np.uint8]) -> None:
        """Write a picture [H, W, 3] over its background, and its mask [H, W]; the mask first."""
        if shot.mask is not None:
            write_whole(shot.mask, [png_bytes(alpha)])
        write_whole(shot.picture, [png_bytes(rgb)])

    def write_mesh(
        self,
        timestep: int,
        vertices: NDArray[np.floating],
        rotation: NDArray[np.floating],
        translation: NDArray[np.floating],
        arkit: NDArray[np.floating],
        truth: NDArray[np.floating] | None = None,
    ) -> None:
        """Write what was tracked at one moment, [V, 3] with the head's pose in it, and where it really was."""
        numbers = {"vertices": vertices, "rotation": rotation, "translation": translation, "arkit": arkit}
        _write_arrays(self.folder / MESHES / mesh_name(timestep), **_as_float32(numbers))
        if truth is not None:
            (self.folder / TRUTH).mkdir(exist_ok=True)
            _write_arrays(self.folder / TRUTH / mesh_name(timestep), **_as_float32({"vertices": truth}))

    def finish(self, shots: Mapping[str, Iterable[Shot]], about: Mapping[str, Any]) -> None:
        """Write the lists of pictures, after which the folder is a capture; train last, which the reader asks for."""
        for split in reversed(SPLITS):
            frames = [frame_of(shot, self.folder) for shot in shots.get(split, ())]
            text = json.dumps({"units": UNITS, **about, "frames": frames})
            write_whole(self.folder / transforms_name(split), [text.encode()])


def _as_float32(arrays: Mapping[str, NDArray[np.floating]]) -> dict[str, NDArray[np.float32]]:
    return {name: np.asarray(value, np.float32) for name, value in arrays.items()}


def _write_arrays(path: Path, **arrays: Any) -> None:
    packed = io.BytesIO()
    np.savez(packed, **arrays)
    write_whole(path, [packed.getvalue()])
