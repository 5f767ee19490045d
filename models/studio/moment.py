"""One moment of a performance in the studio: the posed head, and the light on it, shared by all cameras."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..arkit import NAMES
from ..captures.headmotion import posed
from ..heads.maps import sample_map, strokes
from ..heads.puppet import gaze_turn
from ..heads.skinflow import SPREAD_M, Neighbours, folded, neighbours_of, spread
from .lamps import Lighting, studio_light
from .raster import CUT
from .shading import HAIR
from .shadows import arriving
from .subject import Subject, linear

SKULL = np.array([0.0, 0.035, -0.01])
HAIR_DEPTH_M = 10e-3
"""How deep strands lie in the hair: it shades its inside, not itself."""
STROKES_PX = 9.0
"""Over so many pixels of the hair's picture the direction of strands is averaged."""
EYE_LIFT = 0.06
"""Least irradiance on eyes and teeth, whose own light the lids and lips would swallow."""


@dataclass(frozen=True)
class Act:
    """What the person does at one moment."""

    arkit: NDArray[np.float32]
    """[52] ARKit weights."""
    rotation: NDArray[np.float32]
    """[3] axis times angle of the head about the neck's pivot."""
    translation: NDArray[np.float32]
    """[3] metres."""


@dataclass(frozen=True)
class Moment:
    """The posed head under the lamps."""

    vertices: NDArray[np.float32]
    """[V, 3] world, the tracked ones first."""
    normals: NDArray[np.float32]
    """[V, 3]"""
    light: NDArray[np.float32]
    """[V, 3] irradiance / pi."""
    mean: NDArray[np.float32]
    """[V, 3] where it comes from, mostly."""
    shares: NDArray[np.float32]
    """[V, lamps + 1] how much of each lamp is seen."""
    folds: NDArray[np.float32]
    """[V] how much the skin is compressed, 0..1."""
    slopes: NDArray[np.float32]
    """[F, 2, 3] gradients of u and v along the surface."""
    strands: NDArray[np.float32]
    """[L, 3, 3] the direction of hair at the corners of the cards."""
    eyes: NDArray[np.float32]
    """[2, 7] middle of each eyeball, where it looks, its radius."""


class Stage:
    """What stays the same over a performance: the person and the lamps."""

    def __init__(self, subject: Subject, lighting: Lighting | None = None) -> None:
        self.subject = subject
        self.lighting = studio_light() if lighting is None else lighting
        template = subject.template
        self.parts = np.concatenate([template.parts, np.full(len(subject.card_triangles), HAIR)]).astype(np.uint8)
        self.uv = np.concatenate([template.uv[template.uv_triangles], subject.card_uv]).astype(np.float32)
        self.hair_color = linear(subject.hair_color)

    @cached_property
    def _rest(self) -> NDArray[np.float32]:
        """[V, 3] the face without expression: what folds are measured from."""
        return self.subject.puppet.pose(np.zeros(len(NAMES), np.float32))

    @cached_property
    def _neighbours(self) -> Neighbours:
        return neighbours_of(self.subject.puppet.vertices, self.subject.triangles)

    @cached_property
    def _blockers(self) -> NDArray[np.int32]:
        """Everything but lashes and the thin ends of hair."""
        subject = self.subject
        middle = subject.card_uv.mean(1)
        rows = np.clip((1 - middle[:, 1]) * subject.hair.shape[0], 0, subject.hair.shape[0] - 1).astype(int)
        columns = np.clip(middle[:, 0] * subject.hair.shape[1], 0, subject.hair.shape[1] - 1).astype(int)
        thick = ~subject.card_is_lash & (subject.hair[rows, columns, 1] > CUT)
        return np.concatenate([subject.template.triangles, subject.card_triangles[thick]])

    def vertices(self, act: Act) -> NDArray[np.float32]:
        """[V, 3] the posed head in the world."""
        subject = self.subject
        bare = subject.puppet.pose(act.arkit)
        pivot = subject.template.neck_pivot
        return posed(bare, subject.neck_weights, pivot, act.rotation, act.translation).astype(np.float32)

    def moment(self, act: Act) -> Moment:
        """The posed head, lit."""
        subject, triangles = self.subject, self.subject.triangles
        vertices = self.vertices(act)
        normals = _normals(vertices, subject.template.triangles)
        loose = np.arange(len(vertices)) >= subject.tracked
        outward = vertices[loose] - SKULL
        normals[loose] = outward / np.linalg.norm(outward, axis=1, keepdims=True)
        depth = np.where(loose, HAIR_DEPTH_M, 0.0)
        light, mean, shares = arriving(vertices, normals, self._blockers, depth, self.lighting)
        light = spread(light, self._neighbours, SPREAD_M)
        shares = spread(shares, self._neighbours, (0.0012,) * shares.shape[1])
        pale = np.unique(subject.template.triangles[np.isin(subject.template.parts, (1, 2))])
        light[pale] = np.maximum(light[pale], EYE_LIFT)
        slopes = _slopes(vertices, triangles, self.uv)
        return Moment(
            vertices=vertices,
            normals=normals,
            light=light,
            mean=mean,
            shares=shares,
            folds=folded(self._rest, vertices, subject.template.triangles, self._neighbours),
            slopes=slopes,
            strands=self._strands(slopes),
            eyes=self._eyes(act),
        )

    def _eyes(self, act: Act) -> NDArray[np.float32]:
        puppet, pivot = self.subject.puppet, self.subject.template.neck_pivot
        rows = []
        for side in (0, 1):
            center = puppet.eye_centers[side]
            ends = np.stack([center, center + gaze_turn(act.arkit, side) @ puppet.eye_axes[side]])
            here, ahead = posed(ends, np.ones(2), pivot, act.rotation, act.translation)
            rows.append([*here, *(ahead - here), puppet.eye_radius])
        return np.array(rows, np.float32)

    @cached_property
    def _strokes(self) -> NDArray[np.float32]:
        """[L, 3, 2] which way the strands run on their picture, in u and v, at the corners of the cards."""
        subject = self.subject
        double = sample_map(0.5 + 0.5 * _stroke_field(subject.hair), subject.card_uv.reshape(-1, 2)) * 2 - 1
        angle = 0.5 * np.arctan2(double[:, 1], double[:, 0])
        return np.stack([np.cos(angle), np.sin(angle)], 1).reshape(-1, 3, 2).astype(np.float32)

    def _strands(self, slopes: Floats) -> NDArray[np.float32]:
        """[L, 3, 3] the strokes on the posed cards, those of one card all to the same side."""
        slopes = slopes[len(self.subject.template.triangles) :].astype(np.float64)
        # dP/du and dP/dv are the pseudoinverse of the slopes
        gram = np.linalg.inv(slopes @ slopes.swapaxes(1, 2) + 1e-9 * np.eye(2))
        strands = self._strokes @ (gram @ slopes)
        strands /= np.maximum(np.linalg.norm(strands, axis=2, keepdims=True), 1e-12)
        sides = np.sign((strands * strands[:, :1]).sum(2, keepdims=True))
        return (strands * np.where(sides == 0, 1, sides)).astype(np.float32)


def _stroke_field(hair: NDArray[np.float32]) -> NDArray[np.float32]:
    rgba = np.concatenate([np.repeat(hair[..., :1], 3, -1), (hair[..., 1:] > CUT).astype(np.float32)], -1)
    return strokes(rgba, STROKES_PX)


def _normals(vertices: Floats, triangles: NDArray[np.integer]) -> NDArray[np.float32]:
    """[V, 3] unit, weighted by area."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros((len(vertices), 3))
    for corner in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(triangles[:, corner], face[:, axis], minlength=len(vertices))
    return (total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)).astype(np.float32)


def _slopes(vertices: Floats, triangles: NDArray[np.integer], uv: Floats) -> NDArray[np.float32]:
    """Gradients [F, 2, 3] of u and v along the posed triangles: the pseudoinverse of [dP/du dP/dv]."""
    a, b, c = (vertices[triangles[:, corner]].astype(np.float64) for corner in range(3))
    e, f = b - a, c - a
    ee, ef, ff = (e * e).sum(1), (e * f).sum(1), (f * f).sum(1)
    det = np.maximum(ee * ff - ef * ef, 1e-20)
    toward_b = (ff[:, None] * e - ef[:, None] * f) / det[:, None]
    toward_c = (ee[:, None] * f - ef[:, None] * e) / det[:, None]
    d1, d2 = (uv[:, 1] - uv[:, 0]).astype(np.float64), (uv[:, 2] - uv[:, 0]).astype(np.float64)
    slopes = d1[:, :, None] * toward_b[:, None] + d2[:, :, None] * toward_c[:, None]
    return slopes.astype(np.float32)
