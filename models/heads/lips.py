"""Lips: what an open jaw, pucker and funnel need beyond MakeHuman's shapes.

MakeHuman's open mouth is a triangle on its point, and its pursed one hardly narrower than at rest.
"""

from dataclasses import dataclass

import numpy as np

from ...render.arrays import Floats
from .mesh import QuadMesh, triangulate, vertex_normals

CORNER, MIDDLE, LOWER = 7184, 474, 493
"""Vertices of the base mesh: the left corner of the mouth, and the middles of the lips' edges."""
MOUTH_CENTER = np.array([0, -0.068, 0.0])
"""Metres on the canvas."""
JAW_DROP = 0.34
"""Decimetres that jawOpen lowers the lower lip; the share of it says how far a point belongs to that lip."""
LIP_ENDS, CHIN_BEGINS = 0.65, 1.4
"""Half widths of the mouth below its corners: down to here it is the lower lip, and from here on the chin."""
LEVEL = (1.1, 0.8, 0.55)
"""What a level upper lip does of MakeHuman's motion in its middle and beside it, and from how many half widths of the
mouth on it is beside."""
BOWL = (0.85, 1.25, 0.76, 0.22)
"""What a lower lip like a bowl does of MakeHuman's motion in its middle and beside it; where that is, and how wide, in
half widths of the mouth."""
WALL = 0.028
"""Decimetres by which the mouth's walls are drawn back."""


@dataclass(frozen=True)
class Purse:
    """How one shape purses the lips, at weight 1."""

    narrow: float
    """Share of the mouth's width that is lost."""
    forward: float
    """Decimetres the lips are pushed out."""
    up: float = 0.0
    """Decimetres the upper lip rises in the middle: the upper half of a round opening."""
    down: float = 0.0
    """Decimetres the lower lip sinks in the middle."""
    full: float = 0.0
    """Share by which the red of the lips swells in height."""
    kept: float = 1.0
    """Share of MakeHuman's own vertical motion that stays; the funnel's opens a rhombus."""


PURSES = {
    "mouthPucker": Purse(narrow=0.20, forward=0.02, full=0.12),
    "mouthFunnel": Purse(narrow=0.28, forward=0.03, up=0.035, down=0.05, kept=0.4),
}


def arching(body: Floats, jaw_open: Floats) -> Floats:
    """What to add to MakeHuman's jawOpen ``jaw_open`` [V, 3] on the base mesh ``body`` [V, 3], and to take off
    mouthClose, which undoes it: [V, 3] decimetres by which lower lip and the skin below sink between corner and middle.

    MakeHuman's lip runs almost straight from one to the other. With x^1.5 (1 - x) of the middle's drop added, at the
    share x of the way out, it is an arch: close to 1 - x^3.5.
    """
    x, y, depth = _from_corners(body)
    x = np.abs(x)
    near = np.exp(-((y / 0.85) ** 4)) * np.clip(1.6 - depth / 0.2, 0, 1)
    # the share of a point that moves with the jaw more than the corners do: none of the upper lip
    lower = np.clip((jaw_open[CORNER, 1] - jaw_open[:, 1]) / 0.05, 0, 1)
    sunk = np.zeros_like(jaw_open)
    sunk[:, 1] = jaw_open[LOWER, 1] * np.clip(x**1.5 * (1 - x), 0, None) * near * lower
    return sunk


def lip_alone(body: Floats, chin_follows: float) -> Floats:
    """[V] shares of MakeHuman's mouthLowerDown that stay on the base mesh ``body`` [V, 3]: all of the lip's motion, of
    the chin's ``chin_follows``.

    MakeHuman's moves the fold above the chin further than the lip. In people's grins lips sink and chins hardly do
    (``tests/bench/mouths.py``).
    """
    _, y, _ = _from_corners(body)
    down = np.clip((-y - LIP_ENDS) / (CHIN_BEGINS - LIP_ENDS), 0, 1)
    return 1 - (1 - chin_follows) * down**2 * (3 - 2 * down)


def level(body: Floats, share: float) -> Floats:
    """[V] shares of MakeHuman's mouthUpperUp that stay on the base mesh ``body`` [V, 3], with ``share`` in [0, 1] of
    what makes the upper lip level when both its halves rise with the corners of a smile.

    MakeHuman's halves rise most between middle and corner: the edge of a lip in a grin was an M, as a snarl's is.
    """
    x, _, _ = _from_corners(body)
    middle, beside, begins = LEVEL
    out = np.clip(np.abs(x) / begins, 0, 1)
    return _beside_mouth(body, middle + (beside - middle) * out**2 * (3 - 2 * out), share)


def bowl(body: Floats, share: float) -> Floats:
    """[V] shares of MakeHuman's mouthLowerDown that stay on the base mesh ``body`` [V, 3], with ``share`` in [0, 1] of
    what makes the edge of the lower lip in a grin round; MakeHuman's was a V."""
    x, _, _ = _from_corners(body)
    middle, beside, at, wide = BOWL
    return _beside_mouth(body, middle + (beside - middle) * np.exp(-(((np.abs(x) - at) / wide) ** 2)), share)


def pursed(shape: Purse, unit: Floats, body: Floats, jaw_open: Floats) -> Floats:
    """MakeHuman's displacement ``unit`` [V, 3] of the base mesh ``body`` [V, 3], with the lips pursed; decimetres.

    ``jaw_open`` [V, 3] is the displacement of jawOpen.
    """
    x, y, depth = _from_corners(body)
    near = np.exp(-((x / 1.45) ** 4) - (y / 0.85) ** 4) * np.clip(1.6 - depth / 0.2, 0, 1)
    lips = np.exp(-((x / 1.1) ** 4) - (y / 0.5) ** 4) * np.clip(1.5 - depth / 0.2, 0, 1)
    lower = np.clip(-jaw_open[:, 1] / JAW_DROP, 0, 1)
    round_opening = np.sqrt(np.clip(1 - x**2, 0, 1))
    across = -shape.narrow * body[:, 0] * near
    upward = (shape.up * (1 - lower) - shape.down * lower) * round_opening * near
    upward = upward + shape.full * body[CORNER, 0] * y * lips
    ahead = shape.forward * near * np.exp(-(x**2))
    return unit * np.array([1, shape.kept, 1]) + np.stack([across, upward, ahead], 1)


def _beside_mouth(body: Floats, factor: Floats, share: float) -> Floats:
    """[V] ``factor`` [V] at the lips, 1 far from them, and ``share`` of the way from 1 to it."""
    _, y, depth = _from_corners(body)
    return 1 + share * (factor - 1) * np.exp(-((y / 0.85) ** 4)) * np.clip(1.6 - depth / 0.2, 0, 1)


def _from_corners(body: Floats) -> tuple[Floats, Floats, Floats]:
    """Of each point [V]: how far it is to the left of the mouth's middle and above its corners, in half widths of the
    mouth, and how far behind the upper lip, decimetres."""
    half = body[CORNER, 0]
    return body[:, 0] / half, (body[:, 1] - body[CORNER, 1]) / half, body[MIDDLE, 2] - body[:, 2]


def hollowed(body: Floats, base: QuadMesh, inside: Floats) -> Floats:
    """The body [V, 3] with the walls of its mouth, ``inside`` [V] in [0, 1], drawn back from lips and cheeks.

    MakeHuman's cheeks are so thin that the walls would show through the folds of a pursed mouth.
    """
    return body + WALL * inside[:, None] * vertex_normals(body, triangulate(base.quads))


def mouth_light(rim: Floats, teeth: float) -> float:
    """Share in [0, 1] of the light outside that reaches the incisors.

    The form factor of a disc as large as the opening, r^2 / (r^2 + d^2), seen from its axis at the depth d of the teeth
    behind the lips. ``rim`` [3, 3] are CORNER, MIDDLE and LOWER of the posed lips, ``teeth`` the incisors' z.
    """
    corner, upper, lower = rim
    radius_squared = max(float(corner[0] * (upper[1] - lower[1])), 0.0) / 2
    depth = max(float(upper[2]) - teeth, 2e-3)
    return radius_squared / (radius_squared + depth**2)
