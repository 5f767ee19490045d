"""Teeth of our own: two smooth arches of crowns and gums where MakeHuman's teeth are, and the map painted on them.

MakeHuman's teeth are some fifty closed bodies in thick gums; as splats a millimetre apart they break into blotches.
One band an arch, its crowns told apart by paint, stays whole from every side.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

COLUMNS = 61
SWEEP_RAD = 1.25
"""From the middle to the last molar, about the arch's centre."""
PROFILE_MM = (
    (-4.5, 11.0), (-1.8, 9.8), (0.0, 8.4), (0.5, 6.0), (0.1, 3.0), (-0.6, 0.8),
    (-1.3, 0.0), (-2.2, 0.9), (-3.6, 4.5), (-5.2, 8.0), (-7.2, 11.0),
)  # fmt: skip
"""Outwards and away from the edge, from the gum at the lip over the edge to the gum at the tongue.

The gum at the lip lies well inside: pursed lips and a dropped chin press against it.
"""
EDGE_ROW = 6
CROWN_MM = 8.6
"""Height of a crown; above it is gum."""
GAPS_MM = {"upper": (0.0, 8.2, 14.4, 21.6, 28.2), "lower": (0.0, 5.4, 11.2, 18.0, 25.0)}
"""Along the arch from its middle: where two crowns meet."""
MAP_HEIGHT, MAP_WIDTH = 256, 1024
MAP_REACH_MM = 50.0
"""Half the map's width in millimetres along the arch."""
OPACITY_LOGITS = (-2.5, 4.0)
"""Of the splats of teeth at MOUTH_LIGHT."""
MOUTH_LIGHT = (0.34, 0.55)
"""Colours are constant, so teeth in a mouth hardly open dim by letting the dark behind them through."""
ENAMEL = np.array([0.74, 0.69, 0.60])
GUM = np.array([0.30, 0.10, 0.095])
"""Linear albedo."""
GAP_MM = 0.8
"""Half the width of the line between two crowns: splats lie a millimetre apart, and a finer line drowns in them."""
GAP_SHADE = np.array([0.42, 0.50, 0.52])
"""What it takes of the enamel's colour."""
LOWER_DIM = 0.52
"""The lower row stands in the shadow of lip and upper row: as bright as the upper one it would be a blot in an open
mouth, and one slab with it behind bared teeth."""


@dataclass(frozen=True)
class Arches:
    """Upper and lower teeth as one mesh, decimetres."""

    vertices: Floats
    """[T, 3], the upper arch first."""
    triangles: NDArray[np.int64]
    """[F, 3]"""
    texture: Floats
    """[F, 3, 2] u across the arches, v: upper half the upper arch, lower half the lower."""


def make_arches(guide: Floats, lower: NDArray[np.bool_]) -> Arches:
    """Arches as wide, deep and high as MakeHuman's teeth ``guide`` [P, 3] decimetres, of which ``lower`` [P] are."""
    rows = len(PROFILE_MM)
    index = np.arange(rows * COLUMNS).reshape(COLUMNS, rows)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    outward = np.stack([np.stack([a, b, c], -1), np.stack([c, b, d], -1)]).reshape(-1, 3)
    vertices, uv = [], []
    for is_lower in (False, True):
        points, along = _arch(guide[lower == is_lower], is_lower)
        vertices.append(points.reshape(-1, 3))
        u = 0.5 + 0.5 * along / MAP_REACH_MM
        # A margin of the map's rows keeps the two arches' paint apart when it is interpolated.
        v = np.linspace(0.99, 0.51, rows) - (0.5 if is_lower else 0)
        uv.append(np.stack(np.broadcast_arrays(u[:, None], v[None]), -1).reshape(-1, 2))
    triangles = np.concatenate([outward, outward[:, ::-1] + rows * COLUMNS])
    return Arches(np.concatenate(vertices), triangles, np.concatenate(uv)[triangles])


def carried(guide: Floats, moves: Floats, lower: NDArray[np.bool_], arches: Arches) -> Floats:
    """Displacements [52, T, 3] of the arches: the affine motion nearest to that of the guide, ``moves`` [52, P, 3]."""
    half = len(arches.vertices) // 2
    result = np.zeros((len(moves), len(arches.vertices), 3))
    for is_lower, where in ((False, slice(0, half)), (True, slice(half, None))):
        chosen = lower == is_lower
        system = np.concatenate([guide[chosen], np.ones((chosen.sum(), 1))], 1)
        flat = moves[:, chosen].transpose(1, 0, 2).reshape(chosen.sum(), -1)
        affine = np.linalg.lstsq(system, flat, rcond=None)[0].reshape(4, len(moves), 3)
        points = np.concatenate([arches.vertices[where], np.ones((half, 1))], 1)
        result[:, where] = np.tensordot(points, affine, 1).transpose(1, 0, 2)
    return result


def _arch(guide: Floats, is_lower: bool) -> tuple[Floats, Floats]:
    """Points [COLUMNS, rows, 3] of one arch and the distance [COLUMNS] along it from its middle, millimetres."""
    middle = np.abs(guide[:, 0]) < 0.08
    edge = guide[middle, 1].max() if is_lower else guide[middle, 1].min()
    front = guide[middle, 2].max() - 0.01
    wide = 0.95 * np.abs(guide[:, 0]).max()
    deep = 0.95 * wide
    angle = np.linspace(-SWEEP_RAD, SWEEP_RAD, COLUMNS)
    x, z = wide * np.sin(angle), front - deep * (1 - np.cos(angle))
    along = np.concatenate([[0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))]) * 100
    normal = np.stack([np.sin(angle) / wide, np.cos(angle) / deep], 1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    out, high = np.array(PROFILE_MM).T / 100
    back = (np.abs(angle) / SWEEP_RAD)[:, None] ** 2
    out = np.where(out < 0, out * (1 + 0.8 * back), out)  # molars are thicker
    # A grin bares the sides of the upper row high up, where MakeHuman's cheeks leave no gum; the chin has no such room.
    high = high * (0.9 - 0.35 * back) if is_lower else high * (1.35 + 0.1 * back)
    high = high + 0.02 * back  # the rows part towards the back
    sign = -1 if is_lower else 1
    points = np.stack([x[:, None] + normal[:, :1] * out, edge + sign * high, z[:, None] + normal[:, 1:] * out], -1)
    return points, along - along[-1] / 2


def opacity_logit(light: float) -> float:
    """Of a tooth's splat when the share ``light`` of the light outside reaches the incisors."""
    return float(np.interp(light, MOUTH_LIGHT, OPACITY_LOGITS))


def paint_teeth(brightness: float) -> NDArray[np.float32]:
    """The teeth's map [MAP_HEIGHT, MAP_WIDTH, 3], linear, row 0 on top: enamel, gaps, gums, and the mouth's own shade.

    ``brightness`` is that of the enamel, of ENAMEL's.

    Light falls in through the lips, so both rows darken along the cheeks, towards the gums and behind the edge.
    """
    along = np.abs((np.arange(MAP_WIDTH) + 0.5) / MAP_WIDTH * 2 - 1) * MAP_REACH_MM
    picture = np.zeros((MAP_HEIGHT, MAP_WIDTH, 3), np.float32)
    half = MAP_HEIGHT // 2
    row = np.interp(np.arange(half), [0.02 * half, 0.98 * half], [0, len(PROFILE_MM) - 1])
    high = np.interp(row, np.arange(len(PROFILE_MM)), [h for _, h in PROFILE_MM])[:, None]
    behind = np.clip((row - EDGE_ROW) / 2, 0, 1)[:, None]
    shade = np.exp(-((along / 24.0) ** 2))[None] * 0.85 + 0.15
    shade = shade * (1 - 0.035 * high) * (1 - 0.6 * behind)
    for top, gaps, dim in ((0, GAPS_MM["upper"], 1.0), (half, GAPS_MM["lower"], LOWER_DIM)):
        gap = np.min([np.abs(along - x) for x in gaps], axis=0)[None]
        line = np.exp(-((gap / GAP_MM) ** 2))
        scallop = CROWN_MM - 2.2 * np.exp(-((gap / 1.6) ** 2))  # the gum reaches down between two crowns
        crown = np.clip((scallop - high) / 0.8, 0, 1)[..., None]
        enamel = ENAMEL * brightness * dim * (1 - GAP_SHADE * line[..., None])
        picture[top : top + half] = (GUM + crown * (enamel - GUM)) * shade[..., None]
    return picture
