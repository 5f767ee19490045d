"""A veil of dark splats over the skin, which expressions draw: shade that comes and goes.

Colours of a GEM are constant, opacities are not. So a shadow is splats of its own, which a face at rest lets through.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats, Floats32, Indices
from .darkening import Darkening, skin_of_face
from .expressions import weights_of
from .lips import MOUTH_CENTER
from .maps import encoded, linear, sample_map
from .performance import perform
from .sampling import scatter
from .shading import Shader
from .skin import points_of
from .soup import SKIN, VEIL
from .splats import Rider, joined, ride

SHADOWS, LINES = 1100, 1500
"""How many splats are soft shadows, and how many lie in lines."""
SHADOW_SIGMA, LINE_SIGMA, NORMAL_SIGMA = 0.75, 0.95, 0.08
"""Of a splat, in distances to its neighbours."""
LIFT_M = 1.0e-3
"""Metres above the skin, or the skin of a fold would hide it."""
LEFT = np.array([0.46, 0.32, 0.30])
"""Of the light on a point, what a splat over it leaves: what is lost in a fold comes back red."""
LEAST = 0.05
"""Where no expression takes more of the light than this is no veil."""
GAMMA = 2.2
"""Light is lost in linear light, splats are drawn over encoded colours."""
OVERLAP = 2.6
"""So many splats of the veil lie over every point, by their weights."""
THINNEST, THICKEST = 0.004, 0.4
"""Opacity of a splat that lets all through, and the most that one has."""
FAINTEST = 0.03
"""A splat that no expression draws beyond this is left out."""
LOOKED_FOR = (
    weights_of(mouthSmile=1),
    weights_of(mouthSmile=1, jawOpen=0.2, mouthUpperUp=0.8, mouthLowerDown=0.5),
    weights_of(browInnerUp=1, browOuterUp=1),
    weights_of(browDown=1),
    weights_of(noseSneer=1),
    weights_of(cheekSquint=1, eyeSquint=1),
    weights_of(mouthPucker=1),
    weights_of(mouthFrown=1),
    weights_of(jawOpen=0.8),
    weights_of(mouthStretch=1),
    weights_of(mouthDimple=1, mouthPress=1),
)
"""Expressions that show where skin darkens."""
NEAR_MOUTH, NEAR_MOUTH_EDGE = np.array([0.030, 0.019, 0.050]), 0.25
"""Half axes of an ellipsoid around lips and mouth, metres on the canvas: none there, for the tracker takes lips with
shaded edges for pursed ones; and over what share of it more the veil begins."""
BESIDE_BROWS = 1e-3 * np.array(
    [
        (0, 0, 0),
        (5, 0, 0),
        (-5, 0, 0),
        (11, 0, 0),
        (-11, 0, 0),
        (17, 0, 0),
        (-17, 0, 0),
        (17, -6, 0),
        (-17, -6, 0),
        (0, 4, 0),
        (0, -4, 0),
    ]
)
"""Metres: no closer to them are lines, which would be taken for hairs."""
SPLIT = 5
"""Edges of triangles are cut into so many parts: lines are finer than triangles."""
REHEARSED = 260
"""Expressions of which is learned how ARKit weights draw the veil."""
PENALTY = 0.3
"""Of a weight's slope, against the misfit of an expression."""


@dataclass(frozen=True)
class Veil:
    """How ARKit weights draw it."""

    rider: Rider
    """Its splats, let through."""
    slopes: Floats32
    """[52, n] what one unit of each weight adds to the logits of their opacity."""

    def logits(self, weights: Floats) -> Floats32:
        """[n] of the opacity, with ARKit ``weights`` [52]. GEMs are linear, so these are: the best that is."""
        thinnest, thickest = _logit(THINNEST), _logit(THICKEST)
        return np.clip(thinnest + np.asarray(weights, np.float32) @ self.slopes, thinnest, thickest).astype(np.float32)


def veil_of(shader: Shader, seen: NDArray[np.bool_], rng: np.random.Generator) -> Veil:
    """The veil over those triangles of the skin that are ``seen`` [F]."""
    head, person = shader.head, shader.person
    rider = _spread(shader, seen, Darkening(head, person.wrinkles, skin_of_face(head)), rng)
    darkening = Darkening(head, person.wrinkles, np.unique(rider.corners))
    performance = perform(np.random.default_rng(person.seed), REHEARSED)
    drawn = np.empty((len(performance), len(rider)), np.float32)
    for row, weights in zip(drawn, performance, strict=True):
        shadow, lines = darkening.lost(head.pose(weights), rider.corners, rider.weights)
        row[:] = _logit(opacity(1 - (1 - shadow) * (1 - lines))) - _logit(THINNEST)
    gram = performance.T @ performance + PENALTY * np.eye(performance.shape[1], dtype=np.float32)
    slopes = np.linalg.solve(gram, performance.T @ drawn).astype(np.float32)
    kept = (performance @ slopes).max(0) > _logit(FAINTEST) - _logit(THINNEST)
    return Veil(rider.chosen(kept), slopes[:, kept])


def opacity(lost: Floats) -> Floats:
    """Of the splats of a veil that takes the share ``lost`` of the light."""
    covered = (1 - (1 - lost) ** (1 / GAMMA)) / (1 - LEFT.mean() ** (1 / GAMMA))
    return np.clip(1 - (1 - np.clip(covered, 0, 0.99)) ** (1 / OVERLAP), THINNEST, THICKEST)


def _logit(share: Floats | float) -> Floats:
    return np.log(share / (1 - np.asarray(share)))


def _spread(shader: Shader, seen: NDArray[np.bool_], darkening: Darkening, rng: np.random.Generator) -> Rider:
    """Splats where some expression darkens the skin, the closer together the more."""
    head, maps = shader.head, shader.maps
    faces = np.flatnonzero(seen & (head.parts == SKIN) & np.isin(head.triangles, darkening.skin).all(1))
    pieces, points = _cut(SPLIT)
    face, piece = np.repeat(faces, len(pieces)), np.tile(points[pieces], (len(faces), 1, 1))
    middle = piece.mean(1)
    poses = [head.pose(weights) for weights in LOOKED_FOR]
    lost = np.array([darkening.lost(pose, head.triangles[face], middle) for pose in poses]).max(0)
    uv, canvas, _ = points_of(head, face, middle)
    bare = 1 - sum(sample_map(one, uv)[:, 0] for one in (maps.lips, maps.mouth, maps.lids))
    bare = np.minimum(bare, 1 - 2 * np.max([shader.brows.at(canvas + offset) for offset in BESIDE_BROWS], axis=0))
    bare = np.minimum(bare, (np.linalg.norm((canvas - MOUTH_CENTER) / NEAR_MOUTH, axis=1) - 1) / NEAR_MOUTH_EDGE)
    bare = np.minimum(bare, 1 - 2 * shader.scalp[head.triangles[face]].max(1))
    corners = np.einsum("nkc,nci->nki", piece, head.vertices[head.triangles[face]].astype(float))
    riders = []
    for share, count, wide in ((lost[0], SHADOWS, SHADOW_SIGMA), (lost[1], LINES, LINE_SIGMA)):
        there = share * np.clip(bare, 0, 1)
        chosen, inside, radius = scatter(corners, np.where(there > LEAST, there, 0), count, rng)
        weights = np.einsum("nk,nkc->nc", inside, piece[chosen])
        riders.append(
            ride(
                head.vertices,
                head.triangles[face[chosen]],
                weights,
                None,
                radius[:, None] * np.array([wide, wide, NORMAL_SIGMA]),
                np.full(len(chosen), THINNEST),
                encoded(linear(shader.color(face[chosen], weights)) * LEFT),
                np.full(len(chosen), VEIL),
                lift=LIFT_M,
            )
        )
    return joined(riders)


def _cut(parts: int) -> tuple[Indices, Floats]:
    """A triangle in ``parts`` squared small ones: their corners [P, 3], of points of which the weights [Q, 3] are."""
    points = [(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    number = {point: place for place, point in enumerate(points)}
    upright = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in points if i + j < parts]
    between = [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in points if i + j < parts - 1]
    return np.array(upright + between), np.array([(parts - i - j, i, j) for i, j in points]) / parts
