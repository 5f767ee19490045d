"""The T-shirt's neckline: where it runs on the mesh."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats

BEND, CURVED = 2.2, 0.09
"""The neckline rises by BEND x^2 metres, up to CURVED to either side."""
SLANT = 0.30
"""How much it falls per metre towards the front."""


def collar_height(position: Floats) -> Floats:
    """Metres [N] above (skin) or below (cloth) the neckline, of points [N, 3] of the head at rest."""
    x, y, z = position.T
    return y + 0.162 + SLANT * (z - 0.03) - BEND * np.clip(x, -CURVED, CURVED) ** 2


def neckline(position: Floats, normal: Floats) -> tuple[Floats, Floats]:
    """How far points [N, 3] of a surface with unit ``normal`` [N, 3] are above the neckline, metres along the surface
    [N]; and the unit direction [N, 3] in which it runs there."""
    across = np.where(np.abs(position[:, 0]) < CURVED, -2 * BEND * position[:, 0], 0)
    rise = np.stack([across, np.ones_like(across), np.full_like(across, SLANT)], 1)
    rise -= (rise * normal).sum(1, keepdims=True) * normal
    steep = np.maximum(np.linalg.norm(rise, axis=1), 1e-3)
    along = np.cross(normal, rise / steep[:, None])
    return collar_height(position) / steep, along


def level_line(
    corners: Floats, heights: Floats, step: float, shift: float = 0.0
) -> tuple[NDArray[np.int64], Floats, Floats]:
    """Points every ``step`` along the line on triangles ``corners`` [F, 3, 3] where ``heights`` [F, 3] pass through 0.

    Returns the triangle [N], barycentric weights [N, 3] and unit direction [N, 3] of each point, in the order of their
    angle about the vertical axis, around which the line must go once at most; the first ``shift`` steps further on.
    """
    above = heights > 0
    crossed = np.flatnonzero(above.any(1) & ~above.all(1))
    above, heights = above[crossed], heights[crossed]
    # the corner that is alone on its side: both of its edges are crossed
    alone = np.where(above.sum(1) == 1, above.argmax(1), (~above).argmax(1))
    rows = np.arange(len(crossed))
    ends = []
    for turn in (1, 2):
        other = (alone + turn) % 3
        share = -heights[rows, alone] / (heights[rows, other] - heights[rows, alone])
        weights = np.zeros((len(crossed), 3))
        weights[rows, alone], weights[rows, other] = 1 - share, share
        ends.append(weights)
    tips = [(corners[crossed] * end[..., None]).sum(1) for end in ends]
    angle = [np.arctan2(tip[:, 0], tip[:, 2]) for tip in tips]
    middle = 0.5 * (tips[0] + tips[1])
    order = np.argsort(np.arctan2(middle[:, 0], middle[:, 2]), kind="stable")
    along = tips[1] - tips[0]
    length = np.linalg.norm(along, axis=1)
    end = np.cumsum(length[order])
    places = np.arange((0.25 + shift) * step, end[-1] if len(end) else 0, step)
    which = np.searchsorted(end, places)
    piece = order[which]
    share = 1 - (end[which] - places) / np.maximum(length[piece], 1e-12)
    forward = np.sin(angle[1] - angle[0])[piece] > 0
    share = np.where(forward, share, 1 - share)[:, None]
    weights = ends[0][piece] * (1 - share) + ends[1][piece] * share
    direction = along[piece] / np.maximum(length[piece, None], 1e-12)
    return crossed[piece], weights, direction
