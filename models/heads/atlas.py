"""A UV map of the avatar's own: every splat gets one texel, and neighbours stay neighbours."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats


def lay_out(canvas: Floats, part: NDArray[np.integer], size: int) -> NDArray[np.uint16]:
    """Column and row [N, 2] of each splat in a map of ``size`` x ``size`` texels, no texel twice.

    Parts come one below the other in bands of whole rows. Within a band the splats are unrolled around the vertical
    axis and halved again and again, by whichever side of the band's piece is longer, until one splat is left per texel.

    Raises ValueError when the bands need more rows than there are.
    """
    texels = np.zeros((len(canvas), 2), np.uint16)
    top = 0
    for one in np.unique(part):
        members = np.flatnonzero(part == one)
        rows = -(-len(members) // size)
        if top + rows > size:
            raise ValueError(f"{len(canvas)} splats in {len(np.unique(part))} parts do not fit {size} x {size} texels")
        around = np.arctan2(canvas[members, 0], canvas[members, 2] + 0.08)
        _halve(members, np.stack([around * 0.09, -canvas[members, 1]], 1), (0, top, size, rows), texels)
        top += rows
    return texels


def _halve(
    members: NDArray[np.int64], flat: Floats, box: tuple[int, int, int, int], texels: NDArray[np.uint16]
) -> None:
    """Give ``members`` at ``flat`` [M, 2] the texels of ``box`` (left, top, width, height >= M texels)."""
    left, top, width, height = box
    if len(members) == 0:
        return
    if width * height == 1:
        texels[members[0]] = (left, top)
        return
    axis = 0 if width >= height else 1
    side = (width, height)[axis]
    half = side // 2
    room, total = half * (height if axis == 0 else width), width * height
    rest = total - room
    share = min(room, max(len(members) - rest, round(len(members) * room / total)))
    order = np.argsort(flat[:, axis], kind="stable")
    first, second = order[:share], order[share:]
    if axis == 0:
        boxes = (left, top, half, height), (left + half, top, width - half, height)
    else:
        boxes = (left, top, width, half), (left, top + half, width, height - half)
    _halve(members[first], flat[first], boxes[0], texels)
    _halve(members[second], flat[second], boxes[1], texels)
