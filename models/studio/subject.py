"""Who stands in the studio: a person's mesh, its shapes, its UV map and what its surfaces are like, from one file."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..captures.layout import Template
from ..gem import Viewing
from ..heads.puppet import Puppet
from ..heads.subjectfile import DELTA_M, SHEEN_RANGE

FOLDER = Path(__file__).parents[2] / "assets" / "subjects"


class SubjectError(Exception):
    """A subject's file that is missing or broken: what, where, and the cure."""


@dataclass(frozen=True)
class Subject:
    """A person; the first ``tracked`` vertices and all of ``template`` are what a tracker knows, the rest is hair."""

    name: str
    puppet: Puppet
    template: Template
    neck_weights: NDArray[np.float32]
    """[V] of all vertices."""
    card_triangles: NDArray[np.int32]
    """[L, 3] hair and lashes."""
    card_uv: NDArray[np.float32]
    """[L, 3, 2] in their own picture."""
    card_is_lash: NDArray[np.bool_]
    """[L]"""
    albedo: NDArray[np.float32]
    """[S, S, 3] linear, in the template's UV map, row 0 on top."""
    detail: NDArray[np.float32]
    """[S, S, 3] sheen, depth of creases in 0..1, height of pores in -1..1."""
    hair: NDArray[np.float32]
    """[H, W, 2] how light (0.5 is the mean) and how opaque."""
    lash: NDArray[np.float32]
    """The same of lashes."""
    hair_color: NDArray[np.float32]
    """[2, 3] sRGB: mean, and light strands."""
    viewing: Viewing

    @property
    def tracked(self) -> int:
        """How many vertices the template has."""
        return len(self.template.vertices)

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """[T + L, 3] the template's, then hair and lashes."""
        return np.concatenate([self.template.triangles, self.card_triangles])


def subject_names() -> tuple[str, ...]:
    """The subjects that ship."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.npz")))


def load_subject(name: str) -> Subject:
    """A subject that ships. Raises SubjectError."""
    path = FOLDER / f"{name}.npz"
    if name not in subject_names():
        raise SubjectError(
            f"{name}: no such subject; there are {', '.join(subject_names()) or 'none in ' + str(FOLDER)}"
        )
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return _subject(name, {key: arrays[key] for key in arrays.files})
    except (OSError, ValueError, KeyError) as error:
        raise SubjectError(f"{path}: is broken ({error}); install gemheads again") from error


def _subject(name: str, arrays: dict[str, NDArray[Any]]) -> Subject:
    tracked = int(arrays["tracked"])
    *target, height = map(float, arrays["viewing"])
    template = Template(
        vertices=arrays["vertices"][:tracked],
        triangles=arrays["triangles"].astype(np.int32),
        uv=arrays["uv"],
        uv_triangles=arrays["uv_triangles"],
        neck_weights=arrays["neck_weights"][:tracked],
        neck_pivot=arrays["neck_pivot"],
        parts=arrays["parts"],
        part_names=tuple(str(part) for part in arrays["part_names"]),
    )
    puppet = Puppet(
        vertices=arrays["vertices"],
        deltas=arrays["deltas"].astype(np.float32) * np.float32(DELTA_M),
        eye_centers=arrays["eye_centers"],
        eye_axes=arrays["eye_axes"],
        eye_radius=float(arrays["eye_radius"]),
        eye_of_vertex=arrays["eye_of_vertex"],
        lid_of_vertex=arrays["lid_of_vertex"],
    )
    detail = _picture(arrays["detail"]) * np.array([SHEEN_RANGE, 1, 2], np.float32) - np.array([0, 0, 1], np.float32)
    return Subject(
        name=name,
        puppet=puppet,
        template=template,
        neck_weights=arrays["neck_weights"],
        card_triangles=arrays["card_triangles"],
        card_uv=arrays["card_uv"],
        card_is_lash=arrays["card_is_lash"],
        albedo=linear(_picture(arrays["albedo"])),
        detail=detail,
        hair=np.ascontiguousarray(_picture(arrays["hair"])[..., :2]),
        lash=np.ascontiguousarray(_picture(arrays["lash"])[..., :2]),
        hair_color=arrays["hair_color"],
        viewing=Viewing((target[0], target[1], target[2]), height),
    )


def _picture(packed: NDArray[np.uint8]) -> NDArray[np.float32]:
    image = cv2.imdecode(packed, cv2.IMREAD_COLOR)
    if image is None:
        raise ValueError("a picture in it cannot be decoded")
    return np.ascontiguousarray(image[..., ::-1]).astype(np.float32) / np.float32(255)


def linear(srgb: Floats) -> NDArray[np.float32]:
    """sRGB to linear light."""
    low, high = srgb / 12.92, ((np.maximum(srgb, 0) + 0.055) / 1.055) ** 2.4
    return np.where(srgb <= 0.04045, low, high).astype(np.float32)
