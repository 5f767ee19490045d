"""What a capture is made of: names in its folder, and what the reader gives out. docs/captures.md is the contract."""

import hashlib
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...render.camera import Camera
from ..brevity import brief

SPLITS = ("train", "val", "test")
"""train: what is learned from; val: the same moments from a camera held out; test: expressions held out."""
TEMPLATE = "template.npz"
IMAGES, MASKS, MESHES, TRUTH = "images", "fg_masks", "meshes", "truth"
UNITS = "m"
WHITE = (1.0, 1.0, 1.0)


class CaptureError(Exception):
    """A capture that cannot be learned from: what is wrong, in which file, and the cure."""

    def __init__(self, where: Path, what: str, cure: str) -> None:
        super().__init__(f"{where}: {brief(what, 300)}; {cure}")
        self.where, self.what, self.cure = where, what, cure

    def __reduce__(self) -> tuple[type["CaptureError"], tuple[Path, str, str]]:
        """It can be pickled: processes that judge pictures tell it to their parent."""
        return type(self), (self.where, self.what, self.cure)


@dataclass(frozen=True)
class Shot:
    """One picture, and the camera that took it."""

    picture: Path
    mask: Path | None
    """How much of each pixel is the person; as large as the picture."""
    camera: Camera
    camera_index: int
    timestep: int
    background: tuple[float, float, float] | None = None
    """sRGB in 0..1 of what is behind the person; None where the list of pictures does not state it."""


@dataclass(frozen=True)
class Template:
    """The mesh that every moment was tracked with, at rest; metres in canonical space (docs/conventions.md)."""

    vertices: NDArray[np.float32]
    """[V, 3]"""
    triangles: NDArray[np.int32]
    """[T, 3]"""
    uv: NDArray[np.float32]
    """[C, 2] in 0..1, v upwards."""
    uv_triangles: NDArray[np.int32]
    """[T, 3] into uv."""
    neck_weights: NDArray[np.float32]
    """[V] share of the head's turn in 0..1."""
    neck_pivot: NDArray[np.float32]
    """[3] the point the head turns about."""
    parts: NDArray[np.uint8]
    """[T] into part_names."""
    part_names: tuple[str, ...]

    def digest(self) -> bytes:
        """SHA-256 of all of it."""
        known = hashlib.sha256()
        for part in fields(self):
            known.update(np.asarray(getattr(self, part.name)).tobytes())
        return known.digest()


@dataclass(frozen=True)
class Tracked:
    """What the tracker saw at one moment, with the head's pose taken out."""

    vertices: NDArray[np.float32]
    """[V, 3] the expression alone, canonical space."""
    rotation: NDArray[np.float32]
    """[3] axis times angle of the head about the pivot, as ``posing.pose_head`` takes it."""
    translation: NDArray[np.float32]
    """[3] metres."""
    arkit: NDArray[np.float32] | None
    """[52] ARKit weights, where the capture knows them."""


def picture_name(timestep: int, camera_index: int) -> str:
    """File name of a picture and of its mask."""
    return f"{timestep:05d}_{camera_index:02d}.png"


def mesh_name(timestep: int) -> str:
    """File name of a moment's tracked mesh."""
    return f"{timestep:05d}.npz"


def transforms_name(split: str) -> str:
    """File name of a split's list of pictures."""
    return f"transforms_{split}.json"
